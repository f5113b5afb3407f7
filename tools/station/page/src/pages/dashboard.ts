// One dashboard: #/dashboard/NAME?pump=3. Engineers edit it (?edit).

import { nothing, render } from 'lit-html';
import { ApiError, query, request } from '../api';
import type { Change, Context, MakePage, Page } from '../context';
import { Board } from '../dashboard/board';
import { emptyDashboard, isName, valuesOf } from '../dashboard/document';
import type { Dashboard } from '../dashboard/document';
import { Editor } from '../dashboard/editor';
import type { Draft } from '../dashboard/editor';
import type { Picture } from '../dashboard/widget';
import { t } from '../i18n';
import { html } from '../markup';
import { link } from '../router';
import { texts as widgetTexts } from '../texts/widgets';
import { empty, errorText, makeElement } from '../view';
import '../../styles/dashboard.css';

export const texts = { ...widgetTexts, 'dashboard.title': ['Dashboard', '仪表盘'] } as const;

const drafts = new Map<string, Draft>();  // changes that were not saved when the page was left

class DashboardPage implements Page {
  readonly element = makeElement('dashboard');
  readonly title: string;
  private readonly name: string;
  private readonly head = document.createElement('div');
  private readonly note = document.createElement('div');
  private readonly pictures = new Map<string, Picture>();
  private board: Board | undefined;
  private editor: Editor | undefined;
  private shown: Draft | undefined;  // the saved version
  private closed = false;

  constructor(private readonly context: Context) {
    this.name = context.route.parts[0] ?? '';
    this.title = this.name;
    this.head.className = 'tools board-head';
    this.element.append(this.head, this.note);
    render(empty(t('loading')), this.note);
    void this.load();
  }

  paint(change: Change): void {
    this.board?.paint(change);
    this.editor?.paint(change);
  }

  close(): void {
    this.closed = true;
    if (this.editor?.changed && this.shown) drafts.set(this.name, this.shown);
    this.editor?.close();
    this.board?.close();
  }

  private get mayEdit(): boolean { return this.context.mayEngineer() && !this.context.route.query.has('kiosk'); }

  private async load(): Promise<void> {
    if (!this.context.me.store) return this.say(t('dashboard.no-store'));
    try {
      const [found, { pictures }] = await Promise.all([
        request<{ version: number; text: string }>(query('/api/dashboard', { name: this.name })).catch((error: unknown) => {
          if (this.mayEdit && isName(this.name) && error instanceof ApiError && error.status === 404) return undefined;
          throw error;
        }),
        request<{ pictures: Picture[] }>('/api/pictures'),
      ]);
      if (this.closed) return;
      for (const picture of pictures) this.pictures.set(picture.name, picture);
      this.shown = found ? { dashboard: JSON.parse(found.text) as Dashboard, base: found.version, name: this.name } :
        { dashboard: emptyDashboard(this.name, this.name), base: 0, name: this.name };
      const draft = drafts.get(this.name);
      drafts.delete(this.name);
      if (this.mayEdit && (draft || !found || this.context.route.query.has('edit'))) this.edit(draft ?? this.shown);
      else this.view();
    } catch (error) {
      if (!this.closed) this.say(errorText(error));
    }
  }

  private say(text: string): void {
    render(html`<h1 class="unseen">${t('dashboard.title')}</h1>${empty(text)}<p><a href=${link('dashboards')}>${t('dashboards.title')}</a></p>`, this.note);
  }

  private view(): void {
    const { dashboard } = this.shown!;
    this.editor?.close();
    this.editor = undefined;
    this.board = new Board(this.context, this.pictures);
    this.board.show(dashboard, valuesOf(dashboard, this.context.route.query));
    this.element.replaceChildren(this.head, this.board.element);
    this.drawHead(dashboard);
    this.context.plant.touch('connection');
  }

  private edit(draft: Draft): void {
    this.board?.close();
    this.board = undefined;
    this.shown = { ...draft };
    this.editor = new Editor(this.context, this.pictures, this.shown, {
      saved: (dashboard) => {
        if (dashboard.name === this.name) this.view();
        else this.context.go(link('dashboard', [dashboard.name]));
      },
      left: () => this.leave(),
    });
    this.element.replaceChildren(this.head, this.editor.element);
    this.drawHead(draft.dashboard);
  }

  // Shows the saved version again; a new dashboard that was never saved has none.
  private leave(): void {
    this.editor?.close();
    this.editor = undefined;
    this.context.go(this.shown!.base ? link('dashboard', [this.shown!.name], this.values()) : link('dashboards'));
    if (!this.context.route.query.has('edit') && this.shown!.base) void this.load();
  }

  private values(): Record<string, string> { return { ...valuesOf(this.shown!.dashboard, this.context.route.query) }; }

  private drawHead(dashboard: Dashboard): void {
    const values = valuesOf(dashboard, this.context.route.query);
    const choose = (name: string) => (event: Event): void =>
      this.context.go(link('dashboard', [this.name], { ...values, [name]: (event.target as HTMLInputElement).value }));
    const title = dashboard.title.replace(/\$\{([a-z0-9-]+)\}/g, (whole, name: string) => values[name] ?? whole);
    render(html`<h1>${title}</h1>
      ${this.editor ? nothing : (dashboard.parameters ?? []).map(({ name, title: label, values: choices }) => html`<label>${label ?? name}
        ${choices?.length ? html`<select @change=${choose(name)}>${choices.map((choice) => html`<option ?selected=${choice === values[name]}>${choice}</option>`)}</select>` :
          html`<input .value=${values[name] ?? ''} @change=${choose(name)}>`}</label>`)}
      ${this.mayEdit && !this.editor ? html`<button type="button" class="space-before" @click=${() => this.edit(this.shown!)}>${t('dashboard.edit')}</button>` : nothing}`, this.head);
  }
}

export const page: MakePage = (context) => new DashboardPage(context);
