/** A quantity as people read it, by its name, which ends in its unit: "pitch_deg". */
export function quantityOf(name: string): { label: string; unit: "°" | "mm" | "" } {
  const [, label, unit] = /^(.*?)_(deg|mm)$/.exec(name) ?? [name, name, ""];
  return { label: label!, unit: unit === "deg" ? "°" : unit === "mm" ? "mm" : "" };
}

/** The unit behind a number. */
export function behindNumber(unit: string): string {
  return unit === "°" || unit === "" ? unit : ` ${unit}`;
}
