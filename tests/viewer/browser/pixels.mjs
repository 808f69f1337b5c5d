// Looks at screenshots: PNG buffers as Chromium writes them (8 bits, RGB or RGBA, not interlaced).
import assert from "node:assert/strict";
import { inflateSync } from "node:zlib";

/** {width, height, channels, pixels} with the filters of the PNG specification (section 9) undone. */
function decode(png) {
  const parts = [];
  let header;
  for (let at = 8; at < png.length;) {
    const length = png.readUInt32BE(at);
    const kind = png.toString("latin1", at + 4, at + 8);
    const data = png.subarray(at + 8, at + 8 + length);
    if (kind === "IHDR") header = data;
    if (kind === "IDAT") parts.push(data);
    at += 12 + length;
  }
  const [width, height] = [header.readUInt32BE(0), header.readUInt32BE(4)];
  const channels = { 2: 3, 6: 4 }[header[9]];
  assert.ok(header[8] === 8 && channels && header[12] === 0, "an unexpected kind of PNG");
  const packed = inflateSync(Buffer.concat(parts));
  const stride = width * channels;
  const pixels = Buffer.alloc(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = packed[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const i = y * stride + x;
      const left = x >= channels ? pixels[i - channels] : 0;
      const up = y > 0 ? pixels[i - stride] : 0;
      const corner = x >= channels && y > 0 ? pixels[i - stride - channels] : 0;
      pixels[i] = packed[y * (stride + 1) + 1 + x] + predict(filter, left, up, corner);
    }
  }
  return { width, height, channels, pixels };
}

function predict(filter, left, up, corner) {
  switch (filter) {
    case 0: return 0;
    case 1: return left;
    case 2: return up;
    case 3: return (left + up) >> 1;
    default: {
      const [a, b, c] = [Math.abs(up - corner), Math.abs(left - corner), Math.abs(left + up - 2 * corner)];
      return a <= b && a <= c ? left : b <= c ? up : corner;
    }
  }
}

/** Numbers of clearly red (samples in contact), clearly blue (free), teal (device), skin's and any coloured pixels. */
export function countColors(png) {
  const { channels, pixels } = decode(png);
  const counts = { red: 0, blue: 0, teal: 0, skin: 0, colored: 0 };
  for (let i = 0; i < pixels.length; i += channels) {
    const [r, g, b] = [pixels[i], pixels[i + 1], pixels[i + 2]];
    if (r > 170 && g < 100 && b < 110) ++counts.red;
    if (b > 150 && b > r + 70 && b > g + 40) ++counts.blue;
    if (g > r + 40 && b > r + 30 && Math.abs(g - b) < 45) ++counts.teal;
    if (r > 100 && r > g + 12 && r < g + 70 && g > b + 2 && g < b + 40) ++counts.skin;
    if (Math.max(r, g, b) - Math.min(r, g, b) > 60) ++counts.colored;
  }
  return counts;
}

/** How many pixels differ visibly between two pictures of the same size. */
export function differingPixels(first, second) {
  const [a, b] = [decode(first), decode(second)];
  assert.deepEqual([a.width, a.height, a.channels], [b.width, b.height, b.channels]);
  let count = 0;
  for (let i = 0; i < a.pixels.length; i += a.channels) {
    let change = 0;
    for (let c = 0; c < 3; ++c) change += Math.abs(a.pixels[i + c] - b.pixels[i + c]);
    if (change > 30) ++count;
  }
  return count;
}
