// Places of widgets on the grid. A widget that is moved or resized pushes those that it would cover down. Pure.

export type Cells = [column: number, row: number, width: number, height: number];

export const lastRow = 500;
export const mostHeight = 50;

const clamp = (value: number, least: number, most: number): number => Math.max(least, Math.min(most, Math.round(value)));

export const covers = (a: Cells, b: Cells): boolean =>
  a[0] < b[0] + b[2] && b[0] < a[0] + a[2] && a[1] < b[1] + b[3] && b[1] < a[1] + a[3];

export function clamped([column, row, width, height]: Cells, columns: number): Cells {
  const wide = clamp(width, 1, columns);
  return [clamp(column, 0, columns - wide), clamp(row, 0, lastRow), wide, clamp(height, 1, mostHeight)];
}

// Returns all places after the widget `index` was given the place `at`.
export function placed(all: readonly Cells[], index: number, at: Cells, columns: number): Cells[] {
  const result = all.map((cells): Cells => [...cells]);
  result[index] = clamped(at, columns);
  const fixed = [result[index]!];
  const others = result.filter((_, other) => other !== index).sort((a, b) => a[1] - b[1] || a[0] - b[0]);
  for (const cells of others) {
    for (let below = fixed.find((each) => covers(each, cells)); below; below = fixed.find((each) => covers(each, cells)))
      cells[1] = below[1] + below[3];
    fixed.push(cells);
  }
  return result;
}

// The first free place of this size, row by row.
export function freePlace(all: readonly Cells[], size: readonly number[], columns: number): Cells {
  const width = Math.min(size[0] ?? 1, columns), height = size[1] ?? 1;
  for (let row = 0; row < lastRow; row++)
    for (let column = 0; column + width <= columns; column++) {
      const at: Cells = [column, row, width, height];
      if (!all.some((cells) => covers(cells, at))) return at;
    }
  return [0, lastRow, width, height];
}

// Reading order: the order of the elements, also on a phone, where each widget has the whole width.
export const byPlace = (a: Cells, b: Cells): number => a[1] - b[1] || a[0] - b[0];
