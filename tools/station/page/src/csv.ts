// Tables as CSV by RFC 4180. A text that a spreadsheet would take for a formula gets an apostrophe before it: notes and names come
// from people.

export type Cell = string | number | null;

function csvCell(cell: Cell): string {
  if (cell === null) return '';
  if (typeof cell === 'number') return String(cell);
  const text = /^[=+\-@\t\r]/.test(cell) ? `'${cell}` : cell;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export const csvText = (head: readonly string[], rows: readonly (readonly Cell[])[]): string =>
  [head, ...rows].map((row) => row.map(csvCell).join(',')).join('\r\n') + '\r\n';

// ISO 8601 with the milliseconds, in UTC; empty for no time.
export const csvTime = (ms: number | null): string => (ms === null ? '' : new Date(ms).toISOString());

// Gives the file to the browser's downloads. The mark at the begin tells spreadsheets that it is UTF-8.
export function download(name: string, text: string): void {
  const address = URL.createObjectURL(new Blob(['\uFEFF', text], { type: 'text/csv;charset=utf-8' }));
  const anchor = document.createElement('a');
  anchor.href = address;
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
