// The list of dashboards. Engineers also make and delete them, and upload pictures.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from '../api';
import type { Context, MakePage, Page } from '../context';
import { isName } from '../dashboard/document';
import type { Picture } from '../dashboard/widget';
import { bytes, time } from '../format';
import { t } from '../i18n';
import { html } from '../markup';
import { link } from '../router';
import { ask, empty, errorText, makeElement } from '../view';

export const texts = {
  'dashboards.title': ['Dashboards', '仪表盘'], 'dashboards.none': ['There is no dashboard yet.', '尚无仪表盘。'],
  'dashboards.none-hint': ['A user with the role engineer makes dashboards.', '仪表盘由具有工程师角色的用户创建。'],
  'dashboards.name': ['Name', '名称'], 'dashboards.version': ['Version', '版本'], 'dashboards.saved-by': ['Saved by', '保存者'],
  'dashboards.saved-at': ['Saved at', '保存时间'], 'dashboards.delete': ['Delete', '删除'], 'dashboards.new': ['New dashboard', '新建仪表盘'],
  'dashboards.name-hint': ['Lower-case letters, digits and -', '小写字母、数字和 -'], 'dashboards.delete-title': ['Delete {name}?', '删除 {name}？'],
  'dashboards.delete-text': ['All its versions are deleted.', '其所有版本都会被删除。'], 'dashboards.pictures': ['Pictures', '图片'],
  'dashboards.upload': ['Upload', '上传'], 'dashboards.file': ['SVG or PNG, at most 256 KiB', 'SVG 或 PNG，最大 256 KiB'],
  'dashboards.removed': ['Not copied from the SVG: {names}', '未从 SVG 复制：{names}'], 'dashboards.uploaded': ['Picture {name} is saved.', '图片 {name} 已保存。'],
  'dashboards.no-pictures': ['no pictures', '无图片'],
} as const;

interface Head {
  name: string;
  title: string;
  version: number;
  saved_by: string;
  saved_ms: number;
}

function base64Of(file: File): Promise<string> {
  return new Promise((done, failed) => {
    const reader = new FileReader();
    reader.onload = () => done(String(reader.result).split(',', 2)[1] ?? '');
    reader.onerror = () => failed(new Error(reader.error?.message));
    reader.readAsDataURL(file);
  });
}

class DashboardsPage implements Page {
  readonly element = makeElement('dashboards');
  private dashboards: readonly Head[] | undefined;
  private pictures: readonly Picture[] = [];
  private fault = '';

  constructor(private readonly context: Context) {
    this.draw();
    void this.load();
  }

  private async load(): Promise<void> {
    if (!this.context.me.store) {
      this.fault = t('dashboard.no-store');
      return this.draw();
    }
    try {
      const [{ dashboards }, { pictures }] = await Promise.all([
        request<{ dashboards: Head[] }>('/api/dashboards'), request<{ pictures: Picture[] }>('/api/pictures')]);
      this.dashboards = dashboards;
      this.pictures = pictures;
    } catch (error) {
      this.fault = errorText(error);
    }
    this.draw();
  }

  private async act(command: Promise<unknown>): Promise<void> {
    try {
      await command;
      await this.load();
    } catch (error) {
      this.context.say(errorText(error), true);
    }
  }

  private async remove(name: string, path: string, body: unknown): Promise<void> {
    const sure = await ask({ title: t('dashboards.delete-title', { name }), body: t('dashboards.delete-text'), confirm: t('dashboards.delete'), danger: true });
    if (sure) await this.act(request(path, body));
  }

  private readonly create = (event: Event): void => {
    event.preventDefault();
    const name = String(new FormData(event.target as HTMLFormElement).get('name') ?? '').trim();
    if (isName(name)) this.context.go(link('dashboard', [name], { edit: '' }));
    else this.context.say(t('dashboards.name-hint'), true);
  };

  private readonly upload = async (event: Event): Promise<void> => {
    event.preventDefault();
    const form = event.target as HTMLFormElement, data = new FormData(form), file = data.get('file') as File;
    const typed = String(data.get('name') ?? '').trim();
    const name = typed || file.name.toLowerCase().replace(/\.[a-z]+$/, '').replace(/[^a-z0-9]+/g, '-').replace(/^-+/, '').slice(0, 64);
    await this.act((async () => {
      const { removed } = await request<{ removed: string[] }>('/api/pictures/save', { name, data: await base64Of(file) });
      this.context.say(removed.length ? t('dashboards.removed', { names: removed.join(', ') }) : t('dashboards.uploaded', { name }));
      form.reset();
    })());
  };

  private draw(): void {
    const engineer = this.context.mayEngineer();
    render(html`<h1>${t('dashboards.title')}</h1>
      ${this.fault ? empty(this.fault) : !this.dashboards ? empty(t('loading')) : html`
        ${this.dashboards.length ? this.table(this.dashboards, engineer) : empty(t('dashboards.none'), engineer ? '' : t('dashboards.none-hint'))}
        ${engineer ? html`<form class="tools" @submit=${this.create}><label>${t('dashboards.name')} <input name="name" required maxlength="64" autocomplete="off"
            spellcheck="false" autocapitalize="none" placeholder=${t('dashboards.name-hint')}></label><button class="primary">${t('dashboards.new')}</button></form>
          ${this.pictureSection()}` : nothing}`}`, this.element);
  }

  private table(dashboards: readonly Head[], engineer: boolean): TemplateResult {
    return html`<div class="scroll" data-scroll tabindex="0" role="group" aria-label=${t('dashboards.title')}><table class="plain"><thead><tr><th>${t('dashboard.title')}</th><th>${t('dashboards.name')}</th><th class="number">${t('dashboards.version')}</th>
        <th>${t('dashboards.saved-by')}</th><th>${t('dashboards.saved-at')}</th>${engineer ? html`<th><span class="unseen">${t('dashboards.delete')}</span></th>` : nothing}</tr></thead>
      <tbody>${dashboards.map(({ name, title, version, saved_by, saved_ms }) => html`<tr><td><a href=${link('dashboard', [name])}>${title.replace(/\$\{[^}]*\}/g, '…')}</a></td><td>${name}</td>
        <td class="number">${version}</td><td>${saved_by}</td><td>${time(saved_ms)}</td>
        ${engineer ? html`<td><button type="button" class="small" aria-label="${t('dashboards.delete')} ${name}" @click=${() => void this.remove(name, '/api/dashboards/delete', { name, base: version })}>${t('dashboards.delete')}</button></td>` : nothing}</tr>`)}
      </tbody></table></div>`;
  }

  private pictureSection(): TemplateResult {
    return html`<h2>${t('dashboards.pictures')}</h2>
      ${this.pictures.length ? html`<ul class="pictures">${this.pictures.map(({ name, version, type, bytes: size }) => html`<li class="card">
        <img src=${query('/api/picture', { name, v: version })} alt="" loading="lazy"><b>${name}</b> <span class="muted">${type}, ${bytes(size)}</span>
        <button type="button" class="small" aria-label="${t('dashboards.delete')} ${name}" @click=${() => void this.remove(name, '/api/pictures/delete', { name })}>${t('dashboards.delete')}</button></li>`)}</ul>` :
        html`<p class="muted">${t('dashboards.no-pictures')}</p>`}
      <form class="tools" @submit=${this.upload}><label>${t('dashboards.file')} <input type="file" name="file" required accept=".svg,.png,image/svg+xml,image/png"></label>
        <label>${t('dashboards.name')} <input name="name" maxlength="64" autocomplete="off" spellcheck="false" autocapitalize="none"></label><button>${t('dashboards.upload')}</button></form>`;
  }
}

export const page: MakePage = (context) => new DashboardsPage(context);
