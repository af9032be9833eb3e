# An independent computation of SSIM (scikit-image), FLIP and HDR-FLIP (the papers' two-dimensional kernels, double
# precision, no separation), PSNR and MAE. Input: width, height, two files of height x width x 3 float32, linear RGB,
# the test first. Output: one "name value" a line.
import sys

import numpy as np
from scipy.ndimage import correlate

try:
    from skimage.metrics import peak_signal_noise_ratio, structural_similarity
except ImportError:
    print("missing skimage")
    sys.exit(0)

PPD = 67.0
XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
WHITE = XYZ @ np.ones(3)


def display(x):
    x = np.clip(x, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def ycxcz(rgb):
    x, y, z = np.moveaxis(rgb @ XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def from_ycxcz(p):
    y = (p[0] + 16) / 116
    return np.stack([p[1] / 500 + y, y, y - p[2] / 200], -1) * WHITE @ np.linalg.inv(XYZ).T


def hunt_lab(rgb):
    t = rgb @ XYZ.T / WHITE
    d = 6 / 29
    f = np.where(t > d**3, np.cbrt(t), t / (3 * d * d) + 4 / 29)
    L = 116 * f[..., 1] - 16
    a, b = 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])
    return np.stack([L, 0.01 * L * a, 0.01 * L * b])


def hyab(p, q):
    return abs(p[0] - q[0]) + np.hypot(p[1] - q[1], p[2] - q[2])


def grid(radius):
    return np.meshgrid(np.arange(-radius, radius + 1.0), np.arange(-radius, radius + 1.0))


def spatial(p):
    radius = int(np.ceil(3 * np.sqrt(0.04 / (2 * np.pi**2)) * PPD))
    x, y = grid(radius)
    r2 = (x**2 + y**2) / PPD**2
    out = []
    for plane, terms in zip(p, [[(1, 0.0047)], [(1, 0.0053)], [(34.1, 0.04), (13.5, 0.025)]]):
        k = sum(a * np.sqrt(np.pi / b) * np.exp(-np.pi**2 * r2 / b) for a, b in terms)
        out.append(correlate(plane, k / k.sum(), mode="nearest"))
    return np.clip(from_ycxcz(out), 0, 1)


def features(y):
    sigma = 0.5 * 0.082 * PPD
    x, v = grid(int(np.ceil(3 * sigma)))
    g = np.exp(-(x**2 + v**2) / (2 * sigma**2))
    lengths = []
    for k in (-x * g, (x**2 / sigma**2 - 1) * g):
        k = np.where(k > 0, k / k[k > 0].sum(), k / -k[k < 0].sum())
        lengths.append(np.hypot(correlate(y, k, mode="nearest"), correlate(y, k.T, mode="nearest")))
    return lengths


def flip(test, reference):
    test, reference = ycxcz(test), ycxcz(reference)
    largest = hyab(hunt_lab(np.array([0, 1.0, 0])), hunt_lab(np.array([0, 0, 1.0]))) ** 0.7
    e = hyab(hunt_lab(spatial(test)), hunt_lab(spatial(reference))) ** 0.7
    knee = 0.4 * largest
    e = np.where(e < knee, 0.95 / knee * e, 0.95 + (e - knee) / (largest - knee) * 0.05)
    (et, pt), (er, pr) = features((test[0] + 16) / 116), features((reference[0] + 16) / 116)
    f = np.sqrt(np.maximum(abs(et - er), abs(pt - pr)) / np.sqrt(2))
    return e ** (1 - f)


def aces(x):
    x = 0.6 * np.maximum(x, 0)
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)


def hdr_flip(test, reference):
    a, b, c = (0.36 * (2.51 - 0.85 * 2.43), 0.6 * (0.03 - 0.85 * 0.59), -0.85 * 0.14)
    x = max(np.roots([a, b, c]))
    lum = np.sort((reference @ [0.2126, 0.7152, 0.0722]).ravel())
    first, last = np.log2(x / lum[-1]), np.log2(x / lum[lum.size // 2])
    worst = 0
    for stops in np.linspace(first, last, int(max(2, np.ceil(last - first)))):
        worst = np.maximum(worst, flip(aces(2**stops * test), aces(2**stops * reference)))
    return worst


w, h = int(sys.argv[1]), int(sys.argv[2])
a, b = (np.fromfile(p, np.float32).reshape(h, w, 3).astype(np.float64) for p in sys.argv[3:5])
luma = [display(p) @ [0.2126, 0.7152, 0.0722] for p in (a, b)]
print("ssim", structural_similarity(*luma, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                                    data_range=1))
print("psnr", peak_signal_noise_ratio(display(b), display(a), data_range=1))
print("mae", abs(a - b).mean())
print("relmse", ((a - b) ** 2 / (b**2 + 0.01)).mean())
m = flip(np.clip(a, 0, 1), np.clip(b, 0, 1))
print("flip", m.mean())
print("flip-corner", m[0, 0])
print("flip-inside", m[h // 2, w // 3])
print("hdr-flip", hdr_flip(a, b).mean())
