import { html, render } from 'lit-html';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { makeElement } from '../view';

export const page: MakePage = () => {
  const element = makeElement('alarms');
  render(html`<h1>${t('alarms.title')}</h1>`, element);
  return { title: t('alarms.title'), element };
};
