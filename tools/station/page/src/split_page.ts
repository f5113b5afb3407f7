// A page with a list, and beside it the details of the object that its address names: #/NAME/BUS/DEVICE.

import type { Change, Context, Page } from './context';
import { makeElement } from './view';

export abstract class SplitPage implements Page {
  readonly element: HTMLElement;
  protected readonly head = document.createElement('div');
  protected readonly body = document.createElement('div');
  protected readonly details = document.createElement('section');
  protected readonly note = document.createElement('div');  // instead of an empty list
  protected readonly chosen: string;

  // `label`: of the details while no object is chosen.
  constructor(protected readonly context: Context, label: string) {
    this.element = makeElement(`${context.route.name} listing`);
    this.chosen = context.route.parts.slice(0, 2).join('/');
    this.head.className = 'tabs';
    this.body.className = this.chosen ? 'split chosen' : 'split';
    this.details.className = 'card device';
    this.details.dataset['scroll'] = '';
    this.details.tabIndex = 0;
    this.details.setAttribute('role', 'region');
    this.details.setAttribute('aria-label', this.chosen || label);
    this.note.className = 'nothing';
  }

  abstract paint(change: Change): void;
}
