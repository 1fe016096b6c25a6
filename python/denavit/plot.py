"""Plots of a calibration with matplotlib."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from denavit.fit import Fit
    from denavit.results import Curve


@dataclass(frozen=True, slots=True)
class Plots:
    """Plots of a fit; each draws into `ax`, or into a new figure, and returns the axes. Needs matplotlib."""

    fit: Fit

    def residuals(self, ax: Any = None) -> Any:
        """Histograms of the errors' lengths before and after calibration, mm."""
        ax = _axes(ax)
        before, after = self.fit.residuals_of(0), self.fit.residuals
        adopted = next(errors.stage for errors in self.fit.errors if errors.adopted)
        longest = 1e3 * max((found.distance.max() for found in (before, after) if len(found)), default=1.0)
        bins = np.linspace(0.0, longest, 41)
        for residuals, stage in ((before, "nominal"), (after, adopted)):
            ax.hist(1e3 * residuals.distance, bins=bins, alpha=0.6, label=stage)
        ax.set(xlabel="error, mm", ylabel="observations", title=self.fit.nominal.name)
        ax.legend()
        return ax

    def effects(self, ax: Any = None) -> Any:
        """Each effect's coefficients divided by their standard deviations; the error curves, if there are any."""
        ax = _axes(ax)
        curves = [(curve, curve.range) for curve in self.fit.curves.values() if curve.range is not None]
        if curves:
            return _curves(ax, curves)
        known = [(effect, c, c.sd) for effect in self.fit.effects for c in effect.coefficients if c.sd]
        names = [f"{effect.kind} at {effect.at}: {coefficient.name}" for effect, coefficient, _ in known]
        places = np.arange(len(known))
        ax.barh(places, [coefficient.value / sd for _, coefficient, sd in known])
        ax.set(yticks=places, yticklabels=names, xlabel="coefficient / standard deviation")
        return ax


def _curves(ax: Any, curves: list[tuple[Curve, tuple[float, float]]]) -> Any:
    for curve, ends in curves:
        q = np.linspace(*ends, 400)
        (line,) = ax.plot(q, 1e3 * curve(q), label=curve.joint)
        low, high = curve(q) - curve.sd(q), curve(q) + curve.sd(q)
        ax.fill_between(q, 1e3 * low, 1e3 * high, color=line.get_color(), alpha=0.2)
    units = "/".join(sorted({curve.unit for curve, _ in curves}))
    milli = "/".join(sorted({f"m{curve.unit}" for curve, _ in curves}))
    ax.set(xlabel=f"reading, {units}", ylabel=f"error, {milli}", title="error curves of the joints")
    ax.legend()
    return ax


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    from importlib import import_module

    return import_module("matplotlib.pyplot").subplots(layout="constrained")[1]
