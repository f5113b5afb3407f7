// The draft of one bridge's configuration: its text, undo and redo, and the lines that must not change. Pure.

import type { Configuration, Fault, Protected } from './api';
import { equalLines } from './line_diff';

const mostSteps = 200;
const oneStepWithin_ms = 800;

export const withoutCr = (text: string): string => text.replaceAll('\r\n', '\n');

export class Draft {
  text: string;
  private readonly past: string[] = [];
  private future: string[] = [];
  private typedAt = -Infinity;

  private crlf = false;  // ends of lines in the bridge's file
  base!: Configuration;

  constructor(base: Configuration) {
    this.rebase(base);
    this.text = this.base.text;
  }

  // Sets the version that the draft is compared with. A textarea has ends of lines without CR.
  rebase(base: Configuration): void {
    this.crlf = base.text.includes('\r\n');
    this.base = { ...base, text: withoutCr(base.text) };
  }

  // The text as the bridge's file has it.
  get written(): string { return this.crlf ? this.text.replaceAll('\n', '\r\n') : this.text; }

  get changed(): boolean { return this.text !== this.base.text; }
  get mayUndo(): boolean { return this.past.length > 0; }
  get mayRedo(): boolean { return this.future.length > 0; }

  // `typed_ms`: time of a typed character; characters typed in a row are one step.
  set(text: string, typed_ms?: number): void {
    if (text === this.text) return;
    if (typed_ms === undefined || typed_ms - this.typedAt >= oneStepWithin_ms) this.past.push(this.text);
    if (this.past.length > mostSteps) this.past.shift();
    this.typedAt = typed_ms ?? -Infinity;
    this.future = [];
    this.text = text;
  }

  undo(): void { this.move(this.past, this.future); }
  redo(): void { this.move(this.future, this.past); }

  private move(from: string[], to: string[]): void {
    const text = from.pop();
    if (text === undefined) return;
    to.push(this.text);
    this.text = text;
    this.typedAt = -Infinity;
  }
}

export interface ProtectedLines {
  kept: Map<number, string>;  // line of the draft: why it must not change
  lost: Protected[];  // lines of the base that the draft has changed
}

export function protectedLines(base: string, lines: readonly Protected[], draft: string): ProtectedLines {
  const pairs = new Map(lines.length ? equalLines(base.split('\n'), draft.split('\n')) : []);
  const kept = new Map<number, string>(), lost: Protected[] = [];
  for (const each of lines) {
    const at = pairs.get(each.line - 1);
    if (at === undefined) lost.push(each);
    else kept.set(at + 1, each.why);
  }
  return { kept, lost };
}

// Faults of the draft itself, in the order of its lines; those of other files last.
export const ordered = (faults: readonly Fault[], file: string): Fault[] =>
  [...faults].sort((a, b) => Number(a.file !== file) - Number(b.file !== file) || a.line - b.line || a.column - b.column);
