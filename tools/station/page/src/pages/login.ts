// The login: sends user and password to the station, which returns a cookie that no script can read.

import { nothing, render } from 'lit-html';
import { ApiError, request } from '../api';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { html } from '../markup';
import { errorText, makeElement } from '../view';

export const page: MakePage = () => {
  const element = makeElement('login');
  let trouble = '';
  let busy = false;

  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    const form = new FormData(event.target as HTMLFormElement);
    busy = true;
    draw();
    try {
      await request('/api/login', { user: form.get('user'), password: form.get('password') });
      dispatchEvent(new Event('fieldcast-login'));
      return;
    } catch (error) {
      const status = error instanceof ApiError ? error.status : 0;
      trouble = status === 401 ? t('login.wrong') : status === 429 ? t('login.wait', { n: (error as ApiError).retryAfter_s }) : errorText(error);
    }
    busy = false;
    draw();
    element.querySelector<HTMLInputElement>('#password')?.select();
  };

  const draw = (): unknown => render(html`<form class="card" @submit=${submit}>
      <h1>${t('login.title')}</h1>
      <label for="user">${t('login.user')}</label>
      <input id="user" name="user" autocomplete="username" required autofocus spellcheck="false" autocapitalize="none">
      <label for="password">${t('login.password')}</label>
      <input id="password" name="password" type="password" autocomplete="current-password" required>
      <p class="trouble" role="alert">${trouble || nothing}</p>
      <button class="primary" ?disabled=${busy}>${t('login.go')}</button>
      <p class="muted">${t('login.hint')}</p>
    </form>`, element);
  draw();
  return { title: t('login.title'), element };
};
