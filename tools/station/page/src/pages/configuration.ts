// Configuration: edits, checks and deploys the configuration of a bridge. Its script loads when the page is opened.

import type { MakePage, Page } from '../context';
import { t } from '../i18n';
import { render } from 'lit-html';
import { empty, makeElement } from '../view';
import '../../styles/configuration.css';

export const texts = {
  'configuration.title': ['Configuration', '配置'],
  'configuration.not-loaded': ['The page could not be loaded.', '页面无法加载。'],
  'configuration.reload': ['Reload it: the station may have a new version.', '请重新加载：监控站可能已更新。'],
} as const;

export const page: MakePage = (context) => {
  const element = makeElement('configuration');
  let made: Page | undefined, closed = false;
  render(empty(t('loading')), element);
  import('../configuration/page').then(({ ConfigurationPage }) => {
    if (closed) return;
    made = new ConfigurationPage(context, element);
  }, () => render(empty(t('configuration.not-loaded'), t('configuration.reload')), element));
  return {
    element,
    paint: (change) => made?.paint?.(change),
    focusFilter: () => made?.focusFilter?.(),
    close: () => {
      closed = true;
      made?.close?.();
    },
  };
};
