// Moves the sliders of a page like a user, and returns what the page then says and shows.
async (wanted) => {
  const names = ["x", "y", "z", "roll", "pitch", "yaw"];
  const picker = document.getElementById("chain");
  const tips = wanted.map(({ chain, q }) => {
    if (picker && picker.value !== String(chain)) {
      picker.value = String(chain);
      picker.dispatchEvent(new Event("change", { bubbles: true }));
    }
    document.querySelectorAll("#sliders input").forEach((slider, k) => {
      slider.value = String(q[k]);
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    });
    return Object.fromEntries(names.map((name) => [name, Number(document.getElementById(`tip-${name}`).dataset.value)]));
  });

  // Words of a figure that overlap or extend beyond it.
  const words = (svg) => {
    const view = svg.viewBox.baseVal;
    const boxes = [...svg.querySelectorAll("text")].map((text) => [text.textContent, text.getBBox()]);
    const errors = [];
    boxes.forEach(([one, a], k) => {
      if (a.x < view.x - 1 || a.x + a.width > view.x + view.width + 1 || a.y < view.y - 2 || a.y + a.height > view.y + view.height + 2) {
        errors.push(`"${one}" sticks out`);
      }
      for (const [other, b] of boxes.slice(k + 1)) {
        const wide = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
        const high = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
        if (wide > 3 && high > 5) errors.push(`"${one}" lies on "${other}"`);
      }
    });
    return errors;
  };
  document.querySelectorAll("details").forEach((part) => { part.open = true; });
  const figures = [...document.querySelectorAll("svg.skeleton")];
  const errors = figures.flatMap((svg) => words(svg).map((error) => `${svg.querySelector("title").textContent}: ${error}`));

  await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
  const canvas = document.getElementById("view");
  const pixels = canvas.getContext("2d", { willReadFrequently: true }).getImageData(0, 0, canvas.width, canvas.height).data;
  const colours = { red: 0, blue: 0, grey: 0 };
  for (let k = 0; k < pixels.length; k += 4) {
    const [r, g, b] = pixels.slice(k, k + 3);
    if (pixels[k + 3] < 200) continue;
    if (r > 180 && g < 70 && b < 70) colours.red += 1;
    if (r < 60 && g < 110 && b > 170) colours.blue += 1;
    if (r > 70 && r < 110 && Math.abs(r - b) < 35) colours.grey += 1;
  }
  return { tips, errors, figures: figures.length, colours, width: document.documentElement.scrollWidth };
};
