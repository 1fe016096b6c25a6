//! Numbers of sines and cosines by quarter turns: an angle is reduced in two parts of π/2, then polynomials take what is left,
//! on \[-π/4, π/4\].

/// Beyond this angle, rad, the reduction loses digits and the standard library is used instead.
pub const LARGEST_REDUCED: f64 = 1e5;

/// Leading 33 bits of π/2: its product with a quarter count below 2^20 is exact.
pub const QUARTER_TURN: f64 = f64::from_bits(0x3ff9_21fb_5440_0000);
/// The rest of π/2 to 53 bits; what is left out is below 4e-27.
pub const QUARTER_TURN_REST: f64 = 6.077_100_506_506_192e-11;
/// 1.5 · 2^52: adding it rounds to an integer that then is in the lowest bits.
pub const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// sin r = r + r³ (S\[0\] + r² S\[1\] + ···) on \[-π/4, π/4\], error below 2^-58.
///
/// # Source
/// fdlibm, k_sin.c, Sun Microsystems 1993.
pub const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_007e-6,
    -2.505_076_025_340_686_4e-8,
    1.589_690_995_211_55e-10,
];

/// cos r = 1 - r²/2 + r⁴ (C\[0\] + r² C\[1\] + ···) on \[-π/4, π/4\], error below 2^-58.
///
/// # Source
/// fdlibm, k_cos.c, Sun Microsystems 1993.
pub const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];
