// Writes a tar archive (POSIX.1-1988 ustar) of text files. Pure.

export interface ArchivedFile {
  name: string;  // at most 100 bytes of UTF-8
  text: string;
  at_ms: number;
}

const block = 512, checksumAt = 148, checksumSize = 8;

function header(name: Uint8Array, size: number, at_ms: number): Uint8Array {
  const bytes = new Uint8Array(block), encoder = new TextEncoder();
  const octal = (value: number, digits: number): string => `${Math.max(0, Math.floor(value)).toString(8).padStart(digits, '0')}\0`;
  bytes.set(name.subarray(0, 100));
  for (const [at, text] of [[100, octal(0o644, 7)], [108, octal(0, 7)], [116, octal(0, 7)], [124, octal(size, 11)], [136, octal(at_ms / 1000, 11)],
    [checksumAt, ' '.repeat(checksumSize)], [156, '0'], [257, 'ustar\x0000']] as const) bytes.set(encoder.encode(text), at);
  const sum = bytes.reduce((total, byte) => total + byte, 0);
  bytes.set(encoder.encode(`${octal(sum, 6)} `), checksumAt);
  return bytes;
}

export function tarOf(files: readonly ArchivedFile[]): Uint8Array[] {
  const encoder = new TextEncoder(), parts: Uint8Array[] = [];
  for (const { name, text, at_ms } of files) {
    const content = encoder.encode(text);
    parts.push(header(encoder.encode(name), content.length, at_ms), content, new Uint8Array((block - (content.length % block)) % block));
  }
  return [...parts, new Uint8Array(2 * block)];
}
