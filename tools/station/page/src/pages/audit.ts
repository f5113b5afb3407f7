import { html, render } from 'lit-html';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { makeElement } from '../view';

export const page: MakePage = () => {
  const element = makeElement('audit');
  render(html`<h1>${t('audit.title')}</h1>`, element);
  return { title: t('audit.title'), element };
};
