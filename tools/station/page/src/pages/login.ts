// The login: sends user and password to the station, which returns a cookie that no script can read.

import { nothing, render } from 'lit-html';
import { ApiError, request } from '../api';
import type { MakePage } from '../context';
import { t } from '../i18n';
import { html } from '../markup';
import { errorText, makeElement } from '../view';

export const texts = {
  'login.title': ['Log in', '登录'], 'login.user': ['User', '用户'], 'login.password': ['Password', '密码'], 'login.go': ['Log in', '登录'],
  'login.wrong': ['User or password is wrong.', '用户名或密码错误。'], 'login.wait': ['Too many tries. Wait {n} s.', '尝试次数过多。请等待 {n} 秒。'],
  'login.hint': ['Users are made on the machine of the station: fieldcast user add', '用户在监控站主机上创建：fieldcast user add'],
} as const;

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
  return { element };
};
