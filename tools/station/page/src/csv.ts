// Tables as CSV by RFC 4180. Notes and names are user input, so a text that a spreadsheet would run as a formula gets a leading
// apostrophe.

export type Cell = string | number | null;

function csvCell(cell: Cell): string {
  if (cell === null) return '';
  if (typeof cell === 'number') return String(cell);
  const text = /^[=+\-@\t\r]/.test(cell) ? `'${cell}` : cell;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export const csvText = (head: readonly string[], rows: readonly (readonly Cell[])[]): string =>
  [head, ...rows].map((row) => row.map(csvCell).join(',')).join('\r\n') + '\r\n';

// ISO 8601 with milliseconds, in UTC; empty for null.
export const csvTime = (ms: number | null): string => (ms === null ? '' : new Date(ms).toISOString());

// Starts a browser download of a table. The byte order mark at the start makes spreadsheets read UTF-8.
export const download = (name: string, text: string): void => save(name, `\uFEFF${text}`, 'text/csv;charset=utf-8');

export function save(name: string, content: string | readonly Uint8Array[], type: string): void {
  const address = URL.createObjectURL(new Blob(typeof content === 'string' ? [content] : [...content] as BlobPart[], { type }));
  const anchor = document.createElement('a');
  anchor.href = address;
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
