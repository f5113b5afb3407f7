import { html, render } from 'lit-html';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { makeElement } from '../view';

export const page: MakePage = () => {
  const element = makeElement('programming');
  render(html`<h1>${t('programming.title')}</h1>`, element);
  return { title: t('programming.title'), element };
};
