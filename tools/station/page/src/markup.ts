// The html and svg of lit-html; in addition, every text in a template is passed through printable().

import { html as litHtml, svg as litSvg } from 'lit-html';
import { printable } from './printable';

const shown = (values: unknown[]): unknown[] => values.map((value) => (typeof value === 'string' ? printable(value) : value));

export const html: typeof litHtml = (strings, ...values) => litHtml(strings, ...shown(values));
export const svg: typeof litSvg = (strings, ...values) => litSvg(strings, ...shown(values));
