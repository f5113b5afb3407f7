// The page #/configuration/BRIDGE: text and forms of a draft, its faults and plan, deployment; #/configuration/BRIDGE/versions.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { ApiError } from '../api';
import type { Change, Context, Page } from '../context';
import { save } from '../csv';
import { addTexts, t } from '../i18n';
import { html } from '../markup';
import { printable } from '../printable';
import { link } from '../router';
import { ask, empty, errorText } from '../view';
import { AddDevice } from './add_device';
import * as api from './api';
import type { Checked, Configuration, Fault } from './api';
import { complete } from './completion';
import { askConflict, askDeploy } from './deploy';
import { Draft, ordered, protectedLines, withoutCr } from './draft';
import type { ProtectedLines } from './draft';
import { Editor } from './editor';
import type { LineMark } from './editor';
import { faultList, faultsByKey, sentenceOf } from './fault_list';
import { formFields, keyOf } from './form';
import type { Form } from './form';
import { countChanges } from './line_diff';
import type { ImportedDevice } from './new_device';
import { freeName, nameOf, namesAt, objectOf, outline } from './outline';
import { planView } from './plan_view';
import { schemaAt, withTemplates } from './schema';
import type { Schema } from './schema';
import { texts } from './texts';
import { Versions } from './versions';
import { Watching } from './watching';
import { addItem, removeAt, setAt, setScalar } from './yaml_edit';
import { nodeAt, parseTree, pathAt } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

addTexts(texts);

const parseAfter_ms = 120, checkAfter_ms = 400;

// Drafts are kept while the user looks at other pages, not beyond a reload.
const drafts = new Map<string, Draft>();
addEventListener('beforeunload', (event) => {
  if ([...drafts.values()].some(({ changed }) => changed)) event.preventDefault();
});

const withItems = (text: string, path: Path, items: readonly ImportedDevice[]): string =>
  items.reduce((sum, { text: item }) => addItem(sum, path, item), text);

export class ConfigurationPage implements Page {
  private readonly bridge: string;
  private readonly editor: Editor;
  private readonly versions: Versions | undefined;
  private schema: Schema = {};
  private draft: Draft | undefined;
  private former: string | undefined;  // text in force before the last deployment
  private tree: Node | undefined;
  private lines: ProtectedLines = { kept: new Map(), lost: [] };
  private checked: Checked | undefined;
  private checking: AbortController | undefined;
  private chosen: Path = [];
  private adding: AddDevice | undefined;
  private readonly watching: Watching;
  private fault = '';
  private parseTimer = 0;
  private parsed_ms = 0;  // duration of the last parsing: a large text waits longer for a pause in typing
  private checkTimer = 0;
  private closed = false;

  constructor(private readonly context: Context, readonly element: HTMLElement) {
    this.bridge = context.route.parts[0] ?? [...context.plant.bridges.keys()].sort()[0] ?? '';
    this.editor = new Editor({
      input: (text) => this.change(text, performance.now()),
      moved: (offset) => this.follow(offset),
      undo: () => this.step('undo'),
      redo: () => this.step('redo'),
      complete: (text, offset) => complete(text, offset, this.schema),
    }, t('configuration.text'));
    this.watching = new Watching(context, this.bridge, (read) => this.readAgain(read), () => this.draw());
    if (context.route.parts[1] === 'versions')
      this.versions = new Versions({ bridge: this.bridge, now: () => context.now(), draw: () => this.draw(), say: context.say, returned: () => void this.load(true) });
    void this.load();
  }

  close(): void {
    this.closed = true;
    this.checking?.abort();
    clearTimeout(this.parseTimer);
    clearTimeout(this.checkTimer);
  }

  paint(change: Change): void {
    if (!this.draft && !this.fault && !this.bridge && change.topics.has('bridges') && this.context.plant.bridges.size)
      return this.context.go(link('configuration', [[...this.context.plant.bridges.keys()].sort()[0]!]));
    if (!change.second) return;
    this.watching.tick();
    if (this.watching.running || this.adding) this.draw();
  }

  // `fresh`: the configuration in force was changed by this page; the draft is replaced.
  private async load(fresh = false): Promise<void> {
    if (!this.bridge) return this.draw();
    try {
      const [schema, read] = await Promise.all([api.readSchema(), api.read(this.bridge)]);
      this.schema = schema as Schema;
      this.adopt(read, fresh);
      this.schema = withTemplates(this.schema, (await api.readTemplates()).map(({ name }) => name));
    } catch (error) {
      this.fault = errorText(error);
    }
    this.draw();
  }

  private adopt(read: Configuration, fresh: boolean): void {
    const kept = drafts.get(this.bridge);
    if (!kept || !kept.changed || fresh) drafts.set(this.bridge, this.draft = new Draft(read));
    else this.draft = kept;
    this.watching.update(read);
    this.editor.text = this.draft.text;
    this.parse();
    this.checkSoon(0);
  }

  // The version in force may have changed. After a return to the former text, the draft stays; a deployed draft too. A version of another engineer
  // replaces only an unchanged draft; a changed one meets it as a conflict when it is deployed.
  private readAgain(read: Configuration): void {
    this.watching.update(read);
    const { draft } = this;
    if (draft && read.version !== draft.base.version) {
      if ([this.former, draft.text].includes(withoutCr(read.text))) draft.rebase(read);
      else if (!draft.changed) this.adopt(read, true);
      this.parse();
    }
    this.draw();
  }

  private change(text: string, typed_ms?: number): void {
    if (!this.draft) return;
    this.draft.set(text, typed_ms);
    clearTimeout(this.parseTimer);
    if (typed_ms === undefined) this.parse();
    else this.parseTimer = window.setTimeout(() => this.parse(), Math.max(parseAfter_ms, 3 * this.parsed_ms));
    this.checkSoon(checkAfter_ms);
  }

  private step(way: 'undo' | 'redo'): void {
    if (!this.draft) return;
    this.draft[way]();
    this.editor.text = this.draft.text;
    this.parse();
    this.checkSoon(checkAfter_ms);
  }

  private parse(): void {
    const { draft } = this;
    if (!draft || this.closed) return;
    const begun = performance.now();
    this.tree = parseTree(draft.text);
    this.parsed_ms = performance.now() - begun;
    this.lines = protectedLines(draft.base.text, draft.base.protected, draft.text);
    while (this.chosen.length && !nodeAt(this.tree, this.chosen)) this.chosen = this.chosen.slice(0, -2);
    this.mark();
    this.draw();
  }

  private checkSoon(after_ms: number): void {
    clearTimeout(this.checkTimer);
    this.checking?.abort();
    this.checking = new AbortController();
    const { signal } = this.checking;
    this.checkTimer = window.setTimeout(() => void this.check(signal), after_ms);
  }

  private async check(signal: AbortSignal): Promise<void> {
    const { draft } = this;
    if (!draft) return;
    try {
      const checked = await api.check(this.bridge, draft.written, signal);
      if (signal.aborted) return;
      this.checked = { ...checked, faults: ordered(checked.faults, this.fileName) };
      this.checking = undefined;
      this.fault = '';
    } catch (error) {
      if (signal.aborted) return;
      this.checking = undefined;
      this.checked = undefined;
      this.fault = errorText(error);
    }
    this.mark();
    this.draw();
  }

  // The name that faults have for the text itself.
  private get fileName(): string { return this.draft?.base.path.split('/').pop() ?? ''; }
  private inText({ file }: Fault): boolean { return file === '' || file.split('/').pop() === this.fileName; }
  private faults(): Fault[] { return (this.checked?.faults ?? []).filter((fault) => this.inText(fault)); }

  private mark(): void {
    const faults = this.faults().map<LineMark>((fault) => ({ line: fault.line, column: fault.column, kind: 'fault', text: sentenceOf(fault) }));
    const hidden = this.editor.text.split('\n').flatMap<LineMark>((line, index) => (printable(line) === line ? [] :
      [{ line: index + 1, column: 0, kind: 'hidden', text: `${t('configuration.hidden')} ${line}` }]));
    this.editor.mark([...faults, ...hidden, ...[...this.lines.kept].map<LineMark>(([line, why]) =>
      ({ line, column: 0, kind: 'protected', text: t('configuration.protected-line', { why }) }))]);
  }

  private follow(offset: number): void {
    if (!this.draft || this.adding) return;
    const object = objectOf(pathAt(this.draft.text, this.tree, offset));
    if (keyOf(object) === keyOf(this.chosen)) return;
    this.chosen = object;
    this.draw();
  }

  // After the focused element was removed or disabled.
  private focus(selector: string): void { this.element.querySelector<HTMLElement>(selector)?.focus(); }

  private choose(path: Path): void {
    this.chosen = path;
    const node = nodeAt(this.tree, path);
    if (node) this.editor.select(node.start, node.start, false);
    this.draw();
  }

  // Changes the text by a form; a change that cannot be made leaves the text alone.
  private edit(make: (text: string) => string): void {
    try {
      this.change(make(this.draft!.text));
      this.editor.text = this.draft!.text;
      this.mark();
    } catch (error) {
      this.context.say(t('configuration.cannot', { why: (error as Error).message }), true);
      this.draw();
    }
  }

  private add(path: Path, items: readonly ImportedDevice[]): void {
    const list = nodeAt(this.tree, path), taken = namesAt(this.tree, path) ?? [];
    if (list?.flow && list.children.length && items.some(({ text }) => text.includes('\n'))) return this.context.say(t('configuration.braces'), true);
    this.adding = undefined;
    this.edit((text) => withItems(text, path, items));
    this.choose([...path, taken.length]);
    this.focus('.side');
    this.context.say(t('configuration.added', { name: items.map(({ name }) => name).join(', ') }));
  }

  private addObject(path: Path, name: string, more: string): void {
    const taken = namesAt(this.tree, path) ?? [];
    this.edit((text) => addItem(text, path, `{ name: ${freeName(name, taken)}, ${more} }`));
    this.choose([...path, taken.length]);
  }

  private async remove(): Promise<void> {
    const name = nameOf(this.tree, this.chosen), path = this.chosen;
    if (!await ask({ title: t('configuration.remove', { name }), body: t('configuration.remove-ask', { name }), confirm: t('configuration.remove', { name }), danger: true })) return;
    this.chosen = path.slice(0, -2);
    this.edit((text) => removeAt(text, path));
  }

  private async discard(): Promise<void> {
    const { draft } = this;
    if (!draft) return;
    const changes = countChanges(draft.base.text, draft.text);
    if (!await ask({ title: t('configuration.discard'), body: t('configuration.discard-ask', changes), confirm: t('configuration.discard'), danger: true })) return;
    this.edit(() => draft.base.text);
  }

  private async deploy(): Promise<void> {
    const { draft, checked } = this;
    if (!draft || !checked) return;
    const why = await askDeploy(draft, checked);
    if (why === undefined) return;
    const bad = this.watching.badChannels();
    try {
      this.former = draft.base.text;
      const watch = await api.deploy(this.bridge, draft.base.version, draft.written, why);
      this.watching.begin({ ...watch, base: draft.base.version, state: 'watching' }, bad);
      this.context.say(t('configuration.deployed', { version: watch.version }));
      draft.rebase(await api.read(this.bridge));
    } catch (error) {
      const theirs = error instanceof ApiError && error.status === 409 ? error.answer as Partial<Configuration> : undefined;
      if (theirs?.text !== undefined && theirs.version !== undefined) await this.resolveConflict(draft, { text: withoutCr(theirs.text), version: theirs.version });
      else this.context.say(errorText(error), true);
      // The bridge may have deployed it.
      if (error instanceof ApiError && [0, 504].includes(error.status) && !this.watching.running) this.watching.begin(undefined, bad);
    }
    this.parse();
    this.focus('.watch');
  }

  private async resolveConflict(draft: Draft, theirs: Pick<Configuration, 'version' | 'text'>): Promise<void> {
    const text = await askConflict(draft, theirs);
    if (text === undefined) return;
    draft.rebase(await api.read(this.bridge));
    this.edit(() => text);
  }

  private draw(): void {
    if (this.closed) return;
    const { context, draft, versions } = this;
    const bridges = [...new Set([...context.plant.bridges.keys(), ...(this.bridge ? [this.bridge] : [])])].sort();
    const tab = (label: string, part: readonly string[], shown: boolean): TemplateResult =>
      html`<a href=${link('configuration', [this.bridge, ...part])} aria-current=${shown ? 'page' : nothing}>${label}</a>`;
    const change = (event: Event): void => context.go(link('configuration', [(event.target as HTMLSelectElement).value]));
    render(html`<div class="tabs"><h1>${t('configuration.title')}</h1>
        <label>${t('configuration.bridge')} <select @change=${change}>${bridges.map((name) => html`<option value=${name} ?selected=${name === this.bridge}>${name}</option>`)}</select></label>
        <nav aria-label=${t('configuration.title')}>${tab(t('configuration.edit'), [], !versions)} ${tab(t('configuration.versions'), ['versions'], !!versions)}</nav></div>
      ${!context.mayEngineer() ? empty(t('configuration.role')) : !draft ? empty(this.fault || t(this.bridge ? 'loading' : 'configuration.none')) : html`${this.watching.view()}
        ${versions ? versions.view(draft.base) : this.editPart(draft)}`}`, this.element);
  }

  private editPart(draft: Draft): TemplateResult {
    const { checked } = this, faults = checked?.faults.length ?? 0;
    const may = draft.changed && !!checked && !this.checking && !faults && !this.lines.lost.length && !this.watching.running;
    return html`<div class="tools">
        <button type="button" ?disabled=${!nodeAt(this.tree, ['buses'])?.children.length} @click=${() => this.startAdding()}>${t('configuration.add-device')}</button>
        <button type="button" class="plain" ?disabled=${!draft.mayUndo} @click=${() => this.step('undo')}>${t('configuration.undo')}</button>
        <button type="button" class="plain" ?disabled=${!draft.mayRedo} @click=${() => this.step('redo')}>${t('configuration.redo')}</button>
        <button type="button" class="plain" ?disabled=${!draft.changed} @click=${() => void this.discard()}>${t('configuration.discard')}</button>
        <button type="button" class="plain" @click=${() => save(this.fileName || 'bridge.yaml', draft.written, 'application/yaml')}>${t('configuration.download')}</button>
        <span class="space"></span>
        <span class="muted">${draft.changed ? t('configuration.changed', countChanges(draft.base.text, draft.text)) : t('configuration.unchanged', { version: draft.base.version })}</span>
        <button type="button" class="primary" ?disabled=${!may} @click=${() => void this.deploy()}>${t('configuration.deploy')}</button></div>
      <div class="edit-pair">${this.editor.element}
        <section class="card side" data-scroll tabindex="0" role="region" aria-label=${t('configuration.object')}>${this.adding?.view() ?? this.formPart(draft)}</section></div>
      ${faultList({ failure: this.fault, checking: !!this.checking || !checked, faults: checked?.faults ?? [], lost: this.lines.lost,
        inText: (fault) => this.inText(fault), show: ({ line, column }) => this.editor.selectPlace(line, column), undo: () => this.step('undo') })}
      <section><h2>${t('configuration.plan')}</h2>${planView(checked)}</section>
      ${draft.base.files.length ? html`<section><h2>${t('configuration.files')}</h2>${draft.base.files.map(({ name, text }) =>
        html`<details><summary>${name}</summary><pre class="file" data-scroll tabindex="0" role="region" aria-label=${name}>${text}</pre></details>`)}</section>` : nothing}`;
  }

  private startAdding(): void {
    const bus = this.chosen[0] === 'buses' ? Number(this.chosen[1]) : 0;
    this.adding = new AddDevice({
      bridge: this.bridge, tree: () => this.tree, draw: () => this.draw(), add: (path, items) => this.add(path, items),
      textWith: (path, items) => withItems(this.draft?.text ?? '', path, items),
      cancel: () => {
        this.adding = undefined;
        this.draw();
        this.focus('.tools button');
      },
    }, bus);
    this.draw();
    this.focus('.add-device select');
  }

  private formPart(draft: Draft): TemplateResult {
    const { chosen } = this, level = chosen.length / 2, name = nameOf(this.tree, chosen);
    const form: Form = {
      root: this.schema, schema: schemaAt(this.schema, chosen), text: draft.text, tree: this.tree, path: chosen, faults: faultsByKey(this.faults(), draft.text, this.tree), kept: this.lines.kept,
      set: (path, value, field) => this.edit((text) => (value === '' ? removeAt(text, path) :
        field.kind === 'yaml' ? setAt(text, path, value) : setScalar(text, path, value, field.bare))),
      show: (child) => this.editor.select(child.start, child.end, true),
    };
    return html`${outline(this.tree, chosen, (path) => this.choose(path))}
      <h2>${level ? name : t('configuration.whole')}</h2>
      ${formFields(form)}
      <div class="buttons">${level === 0 ? html`<button type="button" @click=${() => this.addObject(['buses'], 'bus', 'port: { serial: /dev/ttyUSB0 }, protocol: modbus-rtu, devices: []')}>${t('configuration.add-bus')}</button>` : nothing}
        ${level === 2 && !nodeAt(this.tree, [...chosen, 'channels', 0]) && nodeAt(this.tree, [...chosen, 'channels'])?.kind === 'scalar' ? nothing : level >= 2 ? html`
          <button type="button" @click=${() => this.addObject([...chosen.slice(0, 4), 'channels'], 'channel', 'at: "holding:0", type: uint16')}>${t('configuration.add-channel')}</button>` : nothing}
        ${level ? html`<button type="button" class="danger" @click=${() => void this.remove()}>${t('configuration.remove', { name })}</button>` : nothing}</div>`;
  }
}
