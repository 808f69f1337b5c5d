// Reads a frame by the tables of docs/protocol.md alone, so that page and program are held against each other.
import assert from "node:assert/strict";
import { layout } from "./protocol_page.mjs";

const kReaders = {
  u8: [1, (view, at) => view.getUint8(at)],
  u32: [4, (view, at) => view.getUint32(at, true)],
  f32: [4, (view, at) => view.getFloat32(at, true)],
  f64: [8, (view, at) => view.getFloat64(at, true)],
};

/** `count` is a product of a number and fields that were read before: "3*samples". */
const evaluate = (count, fields) => count.split("*").reduce((product, factor) => product * (fields[factor] ?? Number(factor)), 1);

/** The fields of a section from byte `start` on, and where they end. `known` has fields that others of its counts name. */
export function readSection(section, frame, start, known = {}) {
  const view = new DataView(frame);
  const fields = {};
  let at = start;
  for (const { at: said, type, name } of layout(section)) {
    if (said !== null) assert.equal(at - start, said, `${section}: byte of ${name}`);
    if (type === "pad") {
      while (at % 4 !== 0) assert.equal(view.getUint8(at++), 0, `${section}: what is padded is zero`);
      continue;
    }
    const [, kind, , count] = /^(u8|u32|f32|f64)(\[([\w*]+)\])?$/.exec(type);
    const [size, read] = kReaders[kind];
    const next = () => read(view, (at += size) - size);
    fields[name] = count === undefined ? next() : Array.from({ length: evaluate(count, { ...known, ...fields }) }, next);
  }
  return { fields, end: at };
}
