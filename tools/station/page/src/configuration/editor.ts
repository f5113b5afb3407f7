// The text editor: a textarea with line numbers, marks of lines, and proposals at the cursor.

import { nothing, render } from 'lit-html';
import { t } from '../i18n';
import { html } from '../markup';
import type { Completion } from './completion';

export interface LineMark {
  line: number;
  column: number;  // from 1; 0: the whole line
  kind: 'fault' | 'protected' | 'hidden';
  text: string;
}

interface Hooks {
  input(text: string): void;
  moved(offset: number): void;
  undo(): void;
  redo(): void;
  complete(text: string, offset: number): Completion | undefined;
}

const signs = { fault: '▲', protected: '■', hidden: '◆' } as const;
const proposeBelow = 200_000;  // characters; beyond, proposals appear only on request
const lineHeight_px = 20, padding_px = 6;

export class Editor {
  readonly element = document.createElement('div');
  private readonly area = document.createElement('textarea');
  private readonly gutter = document.createElement('div');
  private readonly layer = document.createElement('div');
  private readonly list = document.createElement('div');
  private completion: Completion | undefined;
  private chosen = 0;
  private marks: readonly LineMark[] = [];

  constructor(private readonly hooks: Hooks, label: string) {
    this.element.className = 'yaml';
    this.element.dataset['scroll'] = '';  // the textarea in it scrolls
    this.gutter.className = 'yaml-gutter';
    this.gutter.setAttribute('aria-hidden', 'true');
    this.layer.className = 'yaml-layer';
    this.layer.setAttribute('aria-hidden', 'true');
    this.list.className = 'yaml-proposals';
    Object.assign(this.area, { wrap: 'off', spellcheck: false, autocomplete: 'off', autocapitalize: 'off' });
    for (const [name, value] of [['aria-label', label], ['aria-autocomplete', 'list'], ['data-scroll', '']] as const) this.area.setAttribute(name, value);
    this.element.append(this.gutter, this.layer, this.area, this.list);
    this.area.addEventListener('input', this.input);
    this.area.addEventListener('keydown', this.key);
    this.area.addEventListener('scroll', this.scrolled);
    this.area.addEventListener('blur', () => this.propose(undefined));
    for (const event of ['keyup', 'click']) this.area.addEventListener(event, () => this.hooks.moved(this.area.selectionEnd));
  }

  get text(): string { return this.area.value; }

  // Replaces the text and keeps the cursor at its line.
  set text(text: string) {
    if (text === this.area.value) return;
    const { selectionEnd, scrollTop, scrollLeft } = this.area;
    this.area.value = text;
    this.area.setSelectionRange(selectionEnd, selectionEnd);
    Object.assign(this.area, { scrollTop, scrollLeft });
    this.paint();
  }

  mark(marks: readonly LineMark[]): void {
    this.marks = marks;
    this.paint();
  }

  // Selects a range and scrolls to it.
  select(from: number, to: number, focus: boolean): void {
    this.area.setSelectionRange(from, to);
    if (focus) this.area.focus();
    const line = this.area.value.slice(0, from).split('\n').length - 1;
    const top = line * lineHeight_px, height = this.area.clientHeight;
    if (top < this.area.scrollTop || top > this.area.scrollTop + height - 3 * lineHeight_px) this.area.scrollTop = Math.max(0, top - height / 3);
    this.scrolled();
  }

  selectPlace(line: number, column: number): void {
    const lines = this.area.value.split('\n'), row = Math.max(0, Math.min(lines.length, line) - 1);
    const begin = lines.slice(0, row).reduce((sum, each) => sum + each.length + 1, 0);
    const from = begin + Math.min(lines[row]!.length, Math.max(0, column - 1));
    this.select(from, from + /^[^\s,{}[\]]*/.exec(this.area.value.slice(from))![0].length, true);
    this.hooks.moved(from);
  }

  private paint(): void {
    const lines = this.area.value.split('\n');
    render(html`<pre>${lines.map((_, index) => index + 1).join('\n')}</pre>${this.marks.map(({ line, kind, text }) => html`
      <span class=${kind} title=${text} .style=${`top: ${(line - 1) * lineHeight_px + padding_px}px`}>${signs[kind]}</span>`)}`, this.gutter);
    render(this.marks.map(({ line, column, kind }) => {
      const word = /^[^\s,{}[\]]*/.exec((lines[line - 1] ?? '').slice(Math.max(0, column - 1)))![0].length || 1;
      return html`<span class=${`whole ${kind}`} .style=${`top: ${(line - 1) * lineHeight_px + padding_px}px`}></span>${column ? html`
        <span class="word" .style=${`top: ${(line - 1) * lineHeight_px + padding_px}px; left: calc(${column - 1}ch + ${padding_px}px); width: ${word}ch`}></span>` : nothing}`;
    }), this.layer);
    this.scrolled();
  }

  private readonly scrolled = (): void => {
    this.gutter.style.setProperty('--scroll', `${-this.area.scrollTop}px`);
    this.layer.style.transform = `translate(${-this.area.scrollLeft}px, ${-this.area.scrollTop}px)`;
  };

  private readonly input = (event: Event): void => {
    this.hooks.input(this.area.value);
    this.paint();
    const typed = (event as InputEvent).data;
    const open = typed && /[\w-]/.test(typed) && this.area.value.length < proposeBelow;
    this.propose(open ? this.hooks.complete(this.area.value, this.area.selectionEnd) : undefined);
  };

  private readonly key = (event: KeyboardEvent): void => {
    const command = event.ctrlKey || event.metaKey, { key } = event;
    const take = (action: () => void): void => {
      event.preventDefault();
      action();
    };
    if (command && key.toLowerCase() === 'z') return take(event.shiftKey ? this.hooks.redo : this.hooks.undo);
    if (command && key.toLowerCase() === 'y') return take(this.hooks.redo);
    if (command && key === ' ') return take(() => this.propose(this.hooks.complete(this.area.value, this.area.selectionEnd)));
    const { completion } = this;
    if (completion) {
      const count = completion.proposals.length;
      if (key === 'ArrowDown' || key === 'ArrowUp') return take(() => this.choose((this.chosen + (key === 'ArrowDown' ? 1 : count - 1)) % count));
      if (key === 'Enter' || key === 'Tab') return take(() => this.accept(this.chosen));
      if (key === 'Escape') return take(() => this.propose(undefined));
    }
    if (key === 'Enter' && !command && !event.shiftKey) take(() => this.breakLine());
  };

  // A new line begins in the column of the line before; behind a colon two columns further.
  private breakLine(): void {
    const before = this.area.value.slice(this.area.value.lastIndexOf('\n', this.area.selectionStart - 1) + 1, this.area.selectionStart);
    const indent = /^ *(?:- )?/.exec(before)![0].replace('-', ' ') + (/:\s*$/.test(before) ? '  ' : '');
    this.insert(`\n${indent}`, this.area.selectionStart, this.area.selectionEnd);
  }

  private insert(text: string, from: number, to: number): void {
    this.area.setRangeText(text, from, to, 'end');
    this.hooks.input(this.area.value);
    this.paint();
  }

  private accept(index: number): void {
    const { completion } = this;
    const proposal = completion?.proposals[index];
    if (!completion || !proposal) return;
    this.propose(undefined);
    this.insert(proposal.text + completion.behind, completion.from, completion.to);
    this.area.focus();
  }

  private propose(completion: Completion | undefined): void {
    if (!completion && !this.completion) return;
    this.completion = completion;
    this.choose(0);
  }

  private choose(index: number): void {
    this.chosen = index;
    const { completion, area } = this;
    area.toggleAttribute('aria-activedescendant', false);
    if (!completion) {
      area.removeAttribute('aria-controls');
      render(nothing, this.list);
      return;
    }
    const before = area.value.slice(0, completion.from).split('\n');
    const left = Math.min(this.element.clientWidth - 260, before.at(-1)!.length * 7.8 - area.scrollLeft + 50);
    this.list.style.top = `${before.length * lineHeight_px + padding_px - area.scrollTop}px`;
    this.list.style.left = `${Math.max(0, left)}px`;
    area.setAttribute('aria-controls', 'yaml-list');
    area.setAttribute('aria-activedescendant', `yaml-${index}`);
    render(html`<ul id="yaml-list" role="listbox" aria-label=${t('configuration.proposals')}>${completion.proposals.map(({ text }, at) => html`
      <li id=${`yaml-${at}`} role="option" aria-selected=${at === index} @pointerdown=${(event: Event) => {
        event.preventDefault();
        this.accept(at);
      }}>${text}</li>`)}</ul><p class="muted">${completion.proposals[index]!.description}</p>`, this.list);
    this.list.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  }
}
