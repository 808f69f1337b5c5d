// docs/protocol.md as the tests read it.
import { readFileSync } from "node:fs";

const page = readFileSync(new URL("../../docs/protocol.md", import.meta.url), "utf8");

/** Cells of the rows of a section's table. */
export function rows(section) {
  const [, text] = new RegExp(`^### ${section}\\n([^]*?)(?=^#|$(?![^]))`, "m").exec(page) ?? [];
  if (text === undefined) throw new Error(`docs/protocol.md has no section ${section}`);
  const lines = text.split("\n").filter((line) => line.startsWith("|")).slice(2);
  return lines.map((line) => line.slice(1, -1).split("|").map((cell) => cell.trim()));
}

const unquoted = (cell) => [...cell.matchAll(/`([^`]+)`/g)].map(([, name]) => name);

/** Names in the first column of a table of keys. */
export const keys = (section) => rows(section).flatMap(([key]) => unquoted(key));

/** All names that a section's table has in code. */
export const names = (section) => new Set(rows(section).flatMap((cells) => cells.flatMap(unquoted)));

/** Rows of a table of bytes: where (null: not said), type, name, what it means. */
export const layout = (section) => rows(section).map(([at, type, name, meaning]) =>
  ({ at: at === "" ? null : Number(at), type, name: unquoted(name)[0] ?? "", meaning }));

/** Bits of a field of flags: names by their value, as its meaning has them. */
export function bits(section, field) {
  const { meaning } = layout(section).find(({ name }) => name === field);
  return Object.fromEntries([...meaning.matchAll(/(\d+) `(\w+)`/g)].map(([, bit, name]) => [name, Number(bit)]));
}
