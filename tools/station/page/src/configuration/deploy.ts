// The dialogs of a deployment: what changes and why; and the conflict with somebody else's version.

import type { TemplateResult } from 'lit-html';
import { t } from '../i18n';
import { html } from '../markup';
import { ask, limitBytes } from '../view';
import type { Checked, Configuration } from './api';
import { diffView } from './diff_view';
import type { Draft } from './draft';
import { countChanges, merge } from './line_diff';
import { planView } from './plan_view';

const mostWhyBytes = 256;

const whyField = (): TemplateResult => html`<label class="wide">${t('configuration.why')}
  <input name="why" required maxlength=${mostWhyBytes} @input=${limitBytes(mostWhyBytes)} autofocus aria-describedby="why-hint"></label><p id="why-hint" class="muted">${t('configuration.why-hint')}</p>`;

// Returns the reason, or undefined if the dialog was cancelled.
export async function askDeploy(draft: Draft, checked: Checked): Promise<string | undefined> {
  const { bridge, version, text } = draft.base;
  const answer = await ask({
    title: t('configuration.deploy-title', { bridge }), confirm: t('configuration.deploy-now'),
    body: html`<p>${t('configuration.deploy-body', { version })}</p>${whyField()}
      <p>${t('configuration.changed', countChanges(text, draft.text))}</p>
      ${diffView(text, draft.text, t('configuration.show'))}${planView(checked)}`,
  });
  return answer?.get('why')?.toString();
}

export async function askReturn(version: string): Promise<string | undefined> {
  const answer = await ask({ title: t('configuration.return-of', { version }), confirm: t('configuration.return'), body: whyField() });
  return answer?.get('why')?.toString();
}

// Returns the text of the draft after the conflict, or undefined if the dialog was cancelled.
export async function askConflict(draft: Draft, theirs: Pick<Configuration, 'version' | 'text'>): Promise<string | undefined> {
  const { text: base, version } = draft.base, merged = merge(base, draft.text, theirs.text);
  const option = (value: string, label: string, checked: boolean, disabled = false): TemplateResult =>
    html`<label><input type="radio" name="choice" value=${value} ?checked=${checked} ?disabled=${disabled}>${label}</label>`;
  const answer = await ask({
    title: t('configuration.conflict', { version: theirs.version }), confirm: t('configuration.continue'),
    body: html`<p>${t('configuration.conflict-body', { base: version })}</p>
      <div class="diff-pair"><section><h3>${t('configuration.theirs')}</h3>${diffView(base, theirs.text, t('configuration.theirs'))}</section>
        <section><h3>${t('configuration.mine')}</h3>${diffView(base, draft.text, t('configuration.mine'))}</section></div>
      <div class="options" role="group" aria-label=${t('configuration.draft')}>
        ${option('both', t(merged === undefined ? 'configuration.merge-not' : 'configuration.merge'), merged !== undefined, merged === undefined)}
        ${option('mine', t('configuration.take-mine'), merged === undefined)}
        ${option('theirs', t('configuration.take-theirs', { version: theirs.version }), false)}</div>`,
  });
  const choice = answer?.get('choice');
  return choice === 'both' ? merged : choice === 'mine' ? draft.text : choice === 'theirs' ? theirs.text : undefined;
}
