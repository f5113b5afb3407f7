// Parses the binary frame of the socket: little-endian columns, used in place without a copy. Pure.
//   u8 kind=1 | u8 0 | u16 0 | u32 n | f64 base_ms | f64 value[n] | u32 id[n] | u32 age_ms[n] | u8 quality[n]

export interface Frame {
  base_ms: number;  // acquired = base - age
  value: Float64Array;  // NaN: never acquired, or sent in a `values` message
  id: Uint32Array;
  age_ms: Uint32Array;
  quality: Uint8Array;
}

export const neverAcquired = 0xffffffff;
const headerBytes = 16;
const rowBytes = 8 + 4 + 4 + 1;

// Returns undefined if the bytes are not a frame of this protocol.
export function parseFrame(bytes: ArrayBuffer): Frame | undefined {
  if (bytes.byteLength < headerBytes) return undefined;
  const head = new DataView(bytes);
  const n = head.getUint32(4, true);
  if (head.getUint8(0) !== 1 || bytes.byteLength < headerBytes + n * rowBytes) return undefined;
  let at = headerBytes;
  const value = new Float64Array(bytes, at, n);
  const id = new Uint32Array(bytes, (at += 8 * n), n);
  const age_ms = new Uint32Array(bytes, (at += 4 * n), n);
  const quality = new Uint8Array(bytes, at + 4 * n, n);
  return { base_ms: head.getFloat64(8, true), value, id, age_ms, quality };
}
