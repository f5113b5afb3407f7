// A page with two lists, each at its own address: #/NAME and #/NAME/PART.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import type { Context, Page } from './context';
import { t } from './i18n';
import type { Key } from './i18n';
import { html } from './markup';
import { link } from './router';
import { makeElement } from './view';

export interface Tab extends Page {
  tools?: HTMLElement;
}

export function tabbedPage(context: Context, part: string, labels: readonly [string, string], make: (second: boolean) => Tab): Page {
  const { name, parts } = context.route;
  const second = parts[0] === part;
  const title = t(`${name}.title` as Key);
  const tab = (label: string, address: string, shown: boolean): TemplateResult =>
    html`<a href=${address} aria-current=${shown ? 'page' : nothing}>${label}</a>`;
  const head = document.createElement('div');
  head.className = 'tabs';
  render(html`<h1>${title}</h1><nav aria-label=${title}>
    ${tab(labels[0], link(name), !second)} ${tab(labels[1], link(name, [part]), second)}</nav>`, head);
  const body = make(second);
  const element = makeElement(`${name} listing`);
  element.append(head, ...(body.tools ? [body.tools] : []), body.element);
  return {
    element,
    paint: (change) => body.paint?.(change),
    key: (event) => body.key?.(event) ?? false,
    focusFilter: () => body.focusFilter?.(),
    close: () => body.close?.(),
  };
}
