#include "bridge/configure/configuration_service.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <optional>
#include <utility>

#include "bridge/log/log.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {

namespace {

configure::Outcome forbidden(const std::string& fault) {
  return {403, Json{{"error", fault}, {"hint", ""}}.text()};
}

}  // namespace

std::string refusal_of_requests(const BridgeSpec& spec, bool is_on_loopback) {
  if (!spec.configure.allow)
    return "this bridge does not allow changes from here; an administrator writes "
           "'configure: { allow: true }' in its file";
  if (!spec.dds.security && !is_on_loopback)
    return "this bridge is in a network without DDS Security, where everybody could change it; an "
           "administrator configures dds: security, or interfaces of this machine only";
  return {};
}

ConfigurationService::ConfigurationService(
    const std::string& file, configure::ConfigurationAgent::Ports ports,
    std::function<void(const ConfigurationMessage& reply)> respond)
    : respond_(std::move(respond)),
      thread_([this, file, ports = std::move(ports)] { run(file, ports); }) {}

void ConfigurationService::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void ConfigurationService::refuse_for(std::string reason) {
  const std::lock_guard lock(mutex_);
  refusal_ = std::move(reason);
}

void ConfigurationService::receive(ConfigurationMessage request, std::string subject,
                                   std::string fault) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= kMostWaiting) return;  // the station reports that no reply arrived
    if (fault.empty()) fault = refusal_;
    tasks_.emplace_back(Request{std::move(request), std::move(subject), std::move(fault)});
  }
  changed_.notify_one();
}

void ConfigurationService::reloaded(std::string refusal) { put(Reload{std::move(refusal)}); }

void ConfigurationService::put(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void ConfigurationService::run(const std::string& file,
                               const configure::ConfigurationAgent::Ports& ports) {
  pthread_setname_np(pthread_self(), "configure");
  std::optional<configure::ConfigurationAgent> agent;  // empty while it cannot read its files
  std::string last_error;                              // logged once, not in each look
  const auto look = [&] {
    try {
      if (!agent) agent.emplace(file, ports);
      agent->look();
      last_error.clear();
    } catch (const std::exception& error) {
      if (error.what() != last_error) log_error("configuration", error.what());
      last_error = error.what();
    }
  };
  look();
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const auto ready = [this] { return ending_ || !tasks_.empty(); };
    if (tasks_.empty() && agent && !agent->needs_look()) {
      changed_.wait(lock, ready);
      continue;
    }
    if (!changed_.wait_for(lock, kLook, ready)) {
      lock.unlock();
      look();
      lock.lock();
      continue;
    }
    if (ending_) return;
    auto task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    if (!agent) look();
    agent ? serve(*agent, std::move(task)) : refuse(std::move(task), last_error);
    lock.lock();
  }
}

void ConfigurationService::refuse(Task task, const std::string& error) {
  auto* const request = std::get_if<Request>(&task);
  if (request == nullptr) return;
  if (!request->fault.empty()) return respond(request->message, forbidden(request->fault));
  respond(request->message,
          {500, Json{{"error", printable(error)},
                     {"hint", "an administrator corrects the files of the bridge's machine"}}
                    .text()});
}

void ConfigurationService::serve(configure::ConfigurationAgent& agent, Task task) {
  try {
    if (const auto* reload = std::get_if<Reload>(&task)) return agent.reloaded(reload->refusal);
    if (auto* response = std::get_if<Response>(&task))
      return respond(response->message, response->outcome);
    serve(agent, std::move(std::get<Request>(task)));
  } catch (const std::exception& error) { log_error("configuration", error.what()); }
}

void ConfigurationService::serve(configure::ConfigurationAgent& agent, Request request) {
  ConfigurationMessage& message = request.message;
  if (!request.fault.empty()) return respond(message, forbidden(request.fault));
  const std::string text = std::exchange(message.text, {});
  const auto later = [this, message](configure::Outcome outcome) {
    put(Response{message, std::move(outcome)});
  };
  if (const auto outcome = agent.run(text, request.subject, later)) respond(message, *outcome);
}

void ConfigurationService::respond(ConfigurationMessage& message,
                                   const configure::Outcome& outcome) {
  message.text = Json{{"status", outcome.status}, {"body", outcome.body}}.text();
  if (message.text.size() > ConfigurationMessage::kMostBytes)
    return respond(message, {413, Json{{"error", "the reply is too long for a message"},
                                       {"hint",
                                        "an administrator changes a configuration of this size in "
                                        "its file"}}
                                      .text()});
  respond_(message);
}

}  // namespace fieldcast
