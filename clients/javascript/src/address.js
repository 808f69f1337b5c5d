// Where a softfinger run is.

/**
 * Of an address as the program prints it, or its like: http, https, ws or wss, with its token where it has one.
 * @param {string} text
 */
export function readAddress(text) {
  let url;
  try {
    url = new URL(text.includes("://") ? text : `http://${text}`);
  } catch {
    throw new Error(`softfinger: '${text}' is no address; expected one as the program prints it, e.g. http://127.0.0.1:8080`);
  }
  const scheme = /^(http|ws)(s?):$/.exec(url.protocol);
  if (!scheme) throw new Error(`softfinger: '${text}' is no address of http or https, e.g. http://127.0.0.1:8080`);
  return { origin: `http${scheme[2]}://${url.host}`, token: url.searchParams.get("token") };
}

/** @param {string} origin */
export const socketAddress = (origin) => `${origin.replace(/^http/, "ws")}/ws`;
