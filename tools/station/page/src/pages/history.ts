import { html, render } from 'lit-html';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { makeElement } from '../view';

export const page: MakePage = () => {
  const element = makeElement('history');
  render(html`<h1>${t('history.title')}</h1>`, element);
  return { title: t('history.title'), element };
};
