// Differences of two texts by lines, and the merge of two changes of one text. Pure.

export interface DiffLine {
  kind: 'same' | 'removed' | 'added';
  text: string;
  old: number;  // line number from 1; 0: not in this text
  new: number;
}

const mostSteps = 1000;  // beyond, the rest is one change

// Returns pairs of equal lines in order (the algorithm of E. W. Myers, 1986).
function matches(a: readonly string[], b: readonly string[]): [number, number][] {
  const trace: Map<number, number>[] = [];
  let reach = new Map([[1, 0]]);
  for (let steps = 0; steps <= Math.min(mostSteps, a.length + b.length); steps++) {
    const next = new Map<number, number>();
    for (let diagonal = -steps; diagonal <= steps; diagonal += 2) {
      const down = reach.get(diagonal + 1) ?? -1, right = reach.get(diagonal - 1) ?? -1;
      let x = diagonal === -steps || (diagonal !== steps && right < down) ? down : right + 1;
      while (x < a.length && x - diagonal < b.length && a[x] === b[x - diagonal]) x++;
      next.set(diagonal, x);
      if (x >= a.length && x - diagonal >= b.length) return backtrack([...trace, reach], a.length, b.length);
    }
    trace.push(reach);
    reach = next;
  }
  return [];
}

function backtrack(trace: readonly Map<number, number>[], x: number, y: number): [number, number][] {
  const pairs: [number, number][] = [];
  for (let steps = trace.length - 1; steps >= 0; steps--) {
    const reach = trace[steps]!, diagonal = x - y;
    const down = reach.get(diagonal + 1) ?? -1, right = reach.get(diagonal - 1) ?? -1;
    const from = diagonal === -steps || (diagonal !== steps && right < down) ? diagonal + 1 : diagonal - 1;
    const fromX = steps === 0 ? 0 : reach.get(from)!, fromY = steps === 0 ? 0 : fromX - from;
    while (x > fromX && y > fromY) pairs.push([--x, --y]);
    x = fromX;
    y = fromY;
  }
  return pairs.reverse();
}

// Pairs of equal lines; equal lines at both ends cost nothing.
export function equalLines(a: readonly string[], b: readonly string[]): [number, number][] {
  let head = 0, tail = 0;
  while (head < a.length && head < b.length && a[head] === b[head]) head++;
  while (tail < a.length - head && tail < b.length - head && a[a.length - 1 - tail] === b[b.length - 1 - tail]) tail++;
  const middle = matches(a.slice(head, a.length - tail), b.slice(head, b.length - tail));
  const pairs: [number, number][] = Array.from({ length: head }, (_, n) => [n, n]);
  for (const [x, y] of middle) pairs.push([x + head, y + head]);
  for (let n = tail; n > 0; n--) pairs.push([a.length - n, b.length - n]);
  return pairs;
}

export function diffLines(before: string, after: string): DiffLine[] {
  const a = before.split('\n'), b = after.split('\n'), lines: DiffLine[] = [];
  let x = 0, y = 0;
  const takeUntil = (endX: number, endY: number): void => {
    for (; x < endX; x++) lines.push({ kind: 'removed', text: a[x]!, old: x + 1, new: 0 });
    for (; y < endY; y++) lines.push({ kind: 'added', text: b[y]!, old: 0, new: y + 1 });
  };
  for (const [atX, atY] of equalLines(a, b)) {
    takeUntil(atX, atY);
    lines.push({ kind: 'same', text: a[x++]!, old: atX + 1, new: atY + 1 });
    y++;
  }
  takeUntil(a.length, b.length);
  return lines;
}

// Returns only changed lines with `around` equal lines beside them; undefined stands for lines that are left out.
export function changedLines(lines: readonly DiffLine[], around = 2): (DiffLine | undefined)[] {
  const near = new Set<number>();
  lines.forEach(({ kind }, index) => {
    if (kind !== 'same') for (let at = index - around; at <= index + around; at++) near.add(at);
  });
  const shown: (DiffLine | undefined)[] = [];
  lines.forEach((line, index) => {
    if (near.has(index)) shown.push(line);
    else if (shown.length && shown.at(-1)) shown.push(undefined);
  });
  if (shown.length && !shown.at(-1)) shown.pop();
  return shown;
}

export const countChanges = (before: string, after: string): { added: number; removed: number } => {
  const lines = diffLines(before, after);
  return { added: lines.filter(({ kind }) => kind === 'added').length, removed: lines.filter(({ kind }) => kind === 'removed').length };
};

interface Edit {
  from: number;  // lines of the base that the edit replaces
  to: number;
  lines: string[];
}

function editsOf(base: readonly string[], text: readonly string[]): Edit[] {
  const edits: Edit[] = [];
  let x = 0, y = 0;
  for (const [atX, atY] of [...equalLines(base, text), [base.length, text.length] as [number, number]]) {
    if (atX > x || atY > y) edits.push({ from: x, to: atX, lines: text.slice(y, atY) });
    x = atX + 1;
    y = atY + 1;
  }
  return edits;
}

// Applies both changes of `base`. Undefined if they change the same or adjacent lines in different ways.
export function merge(base: string, mine: string, theirs: string): string | undefined {
  const lines = base.split('\n'), merged: string[] = [];
  const edits = [...editsOf(lines, mine.split('\n')), ...editsOf(lines, theirs.split('\n'))].sort((a, b) => a.from - b.from || a.to - b.to);
  let at = 0;
  let last: Edit | undefined;
  for (const edit of edits) {
    if (last && edit.from === last.from && edit.to === last.to && edit.lines.join('\n') === last.lines.join('\n')) continue;
    if (last && edit.from <= last.to) return undefined;
    merged.push(...lines.slice(at, edit.from), ...edit.lines);
    at = edit.to;
    last = edit;
  }
  return [...merged, ...lines.slice(at)].join('\n');
}
