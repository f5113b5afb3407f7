// The frame of every page: the head with its links, the status line below it, keys, messages. The line never changes its
// height. When the connection is lost, it turns into the banner, and an attribute of the root greys the whole page.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { wantsSomebody } from './alarm_rows';
import type { Change, Page } from './context';
import { age, clock, count } from './format';
import { language, languages, t } from './i18n';
import type { Key, Language } from './i18n';
import type { Live } from './live';
import { html } from './markup';
import { pageOf, pages } from './pages';
import type { Plant } from './plant';
import { printable } from './printable';
import { link } from './router';
import type { Route } from './router';
import { setTheme, theme, themes } from './theme';
import type { Theme } from './theme';
import type { Me } from './types';

interface Actions {
  logout(): Promise<void>;
  chooseLanguage(language: Language): void;
}

const places = (me: Me | undefined): typeof pages => pages.filter(({ key, engineer }) => key && (!engineer || me?.role === 'engineer'));
const titleOf = (name: string): string => t(`${name}.title` as Key);
const chordWithin_ms = 1500;
const messageFor_ms = 6000;

export class Shell {
  private readonly head = document.createElement('header');
  private readonly line = document.createElement('div');
  private readonly main = document.createElement('main');
  private readonly messages = document.createElement('div');
  private me: Me | undefined;
  private name = '';
  private pageTitle = '';
  private menuOpen = false;
  private chordAt = -chordWithin_ms;
  private rateAt = 0;
  private rateSamples = 0;
  private rate = 0;

  constructor(private readonly plant: Plant, private readonly live: Live, private readonly actions: Actions) {
    this.line.className = 'line';
    this.line.setAttribute('role', 'status');
    this.messages.className = 'messages';
    this.messages.setAttribute('role', 'alert');
    this.main.id = 'main';
    this.main.tabIndex = -1;
    if (location.pathname === '/embed') document.documentElement.classList.add('embed');
    document.body.append(this.head, this.line, this.main, this.messages);
  }

  build(me: Me | undefined): void {
    this.me = me;
    document.documentElement.lang = language === 'zh' ? 'zh-CN' : 'en';
    this.renderHead();
    this.renderLine();
  }

  show(name: string, route: Route, page: Page): void {
    this.name = name;
    this.menuOpen = false;
    document.documentElement.classList.toggle('kiosk', route.query.has('kiosk'));
    this.pageTitle = page.title ?? titleOf(name);
    this.showTitle();
    this.main.replaceChildren(page.element);
    this.renderHead();
    const first = page.element.querySelector<HTMLElement>('[autofocus]') ?? this.main;
    if (document.activeElement === document.body || first !== this.main) first.focus({ preventScroll: true });
  }

  say(text: string, bad = false): void {
    const message = document.createElement('p');
    message.className = bad ? 'message bad' : 'message';
    message.textContent = printable(text);
    this.messages.append(message);
    while (this.messages.childElementCount > 3) this.messages.firstElementChild!.remove();
    setTimeout(() => message.remove(), messageFor_ms);
  }

  paint(change: Change): void {
    if (change.topics.has('connection')) document.documentElement.dataset['connection'] = this.live.state;
    if (change.second || change.topics.has('connection') || change.topics.has('alarms')) this.renderLine();
    if (change.topics.has('alarms')) {
      this.renderHead();
      this.showTitle();
    }
  }

  listenToKeys(page: () => Page | undefined): void {
    addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || !this.me?.role) return;
      const target = event.target as HTMLElement;
      if (event.key === 'Escape' && this.menuOpen) return this.toggleMenu();
      if (target.closest('input:not([type="checkbox"]), textarea, select, dialog')) {
        if (event.key === 'Escape' && target.closest('input:not(dialog *)')) {
          event.preventDefault();  // otherwise a search field would lose its text
          target.blur();
        }
        return;
      }
      if (this.key(event, page())) event.preventDefault();
    });
  }

  private key(event: KeyboardEvent, page: Page | undefined): boolean {
    const now = performance.now();
    if (now - this.chordAt < chordWithin_ms) {
      this.chordAt = -chordWithin_ms;
      const place = places(this.me).find(({ key }) => key === event.key);
      if (place) location.hash = link(place.name);
      return place !== undefined;
    }
    if (event.key === 'g') {
      this.chordAt = now;
      return true;
    }
    if (event.key === '?') {
      this.help();
      return true;
    }
    if (event.key === '/' && page?.focusFilter) {
      page.focusFilter();
      return true;
    }
    return page?.key?.(event) ?? false;
  }

  private help(): void {
    const dialog = document.createElement('dialog');
    dialog.setAttribute('aria-labelledby', 'help-title');
    const rows: [string, string][] = [
      ...places(this.me).map(({ key, name }): [string, string] => [`g ${key}`, titleOf(name)]),
      ['/', t('keys.filter')], ['↑ ↓', t('keys.rows')], ['Enter', t('keys.open')], ['Esc', t('keys.leave')], ['?', t('keys.help')],
    ];
    render(html`<form method="dialog"><h2 id="help-title">${t('keys.title')}</h2>
      <dl class="keys">${rows.map(([key, text]) => html`<dt><kbd>${key}</kbd></dt><dd>${text}</dd>`)}</dl>
      <div class="dialog-buttons"><button class="primary">${t('close')}</button></div></form>`, dialog);
    dialog.addEventListener('close', () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }

  private toggleMenu(): void {
    this.menuOpen = !this.menuOpen;
    this.renderHead();
  }

  private unacknowledged(): number {
    let n = 0;
    const now = this.live.now();
    for (const alarm of this.plant.alarms.values()) if (wantsSomebody(alarm, now)) n++;
    return n;
  }

  // Shows alarms in the title, so that a background tab shows them too.
  private showTitle(): void {
    const alarms = this.me?.role ? this.unacknowledged() : 0;
    const title = `${alarms ? `(${alarms}) ` : ''}${this.pageTitle} · Fieldcast`;
    if (document.title !== title) document.title = title;
  }

  private renderHead(): void {
    if (!this.me?.role) {
      render(html`<span class="brand">Fieldcast</span>${this.choices()}`, this.head);
      return;
    }
    const alarms = this.unacknowledged();
    render(html`
      <a class="skip" href="#main" @click=${this.skip}>${t('skip')}</a>
      <a class="brand" href=${link('overview')}>Fieldcast</a>
      <button type="button" class="menu-button" aria-expanded=${this.menuOpen} aria-controls="menu" @click=${() => this.toggleMenu()}>
        ${titleOf(pageOf(this.name)?.under ?? this.name)}${
          alarms ? html` <span class="count">${alarms}</span>` : nothing} ▾</button>
      <div id="menu" class=${this.menuOpen ? 'menu open' : 'menu'}>
        <nav aria-label=${t('nav.label')}>${places(this.me).map(({ name }) => this.navLink(name, name === 'alarms' ? alarms : 0))}</nav>
        ${this.choices()}
        ${this.me.login === 'none' ? nothing : html`<span class="user">${this.me.user}</span>
          <button type="button" class="plain" @click=${() => void this.actions.logout()}>${t('logout')}</button>`}
      </div>`, this.head);
  }

  private readonly skip = (event: Event): void => {
    event.preventDefault();
    this.main.focus();
  };

  private navLink(name: string, number: number): TemplateResult {
    return html`<a href=${link(name)} aria-current=${this.name === name ? 'page' : nothing}>${titleOf(name)}${
      number ? html`<span class="count">${number}</span>` : nothing}</a>`;
  }

  private choices(): TemplateResult {
    const chooseTheme = (event: Event): void => setTheme((event.target as HTMLSelectElement).value as Theme);
    const chooseLanguage = (event: Event): void => this.actions.chooseLanguage((event.target as HTMLSelectElement).value as Language);
    return html`<span class="choices">
      <select aria-label=${t('theme')} @change=${chooseTheme}>${themes.map((each) =>
        html`<option value=${each} ?selected=${each === theme()}>${t(`theme.${each}` as Key)}</option>`)}</select>
      <select aria-label=${t('language')} @change=${chooseLanguage}>${Object.entries(languages).map(([each, name]) =>
        html`<option value=${each} ?selected=${each === language}>${name}</option>`)}</select>
    </span>`;
  }

  private renderLine(): void {
    const { live, plant } = this;
    if (!this.me?.role) {
      render(nothing, this.line);
      return;
    }
    if (live.state === 'lost') {
      const lost = age(performance.now() - live.lostAt), again = Math.max(0, live.retryAt - performance.now());
      render(html`<strong>▲ ${t('lost.title', { age: lost })}</strong>
        <span class="wide">${t('lost.text', { again: `${Math.ceil(again / 1000)} s` })}</span>`, this.line);
      return;
    }
    if (live.state === 'connecting') {
      render(html`<span>○ ${t('connecting')}</span>`, this.line);
      return;
    }
    this.measureRate();
    const { all, bad } = plant.count().get('')!, file = pageOf(this.name)?.doc ?? 'station.md';
    render(html`<span class="ok">● ${t('connected')}</span>
      <span class="fixed">${t('line.rate', { n: count(this.rate) })}</span>
      <span class="wide">${t('line.channels', { n: count(all) })}</span>
      <span class=${bad ? 'bad' : ''}>${bad ? '▲ ' : ''}${t('line.bad', { n: count(bad) })}</span>
      <span class="space"></span>
      <a class="help" target="_blank" href=${`/api/document?name=${file}`} title=${t('keys.doc', { file })}>${t('keys.docs')}</a>
      <button type="button" class="plain help" title=${t('keys.title')} aria-label=${t('keys.title')} @click=${() => this.help()}>?</button>
      <span class="wide muted">${this.me.user} · ${t(`role.${this.me.role}` as Key)}</span>
      <span class="clock">${clock(live.now())}</span>`, this.line);
  }

  private measureRate(): void {
    const now = performance.now();
    if (now - this.rateAt < 900) return;
    this.rate = this.rateAt ? Math.round(((this.plant.samples - this.rateSamples) * 1000) / (now - this.rateAt)) : 0;
    this.rateAt = now;
    this.rateSamples = this.plant.samples;
  }
}
