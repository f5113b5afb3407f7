#include "bridge/configure/configuration_service.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <utility>

#include "bridge/log/log.hpp"
#include "core/base/json.hpp"

namespace fieldcast {

namespace {

std::string reply_text(unsigned status, const std::string& body) {
  return Json{{"status", status}, {"body", body}}.text();
}

std::string refusal_text(unsigned status, const std::string& error, const std::string& hint) {
  return reply_text(status, Json{{"error", error}, {"hint", hint}}.text());
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

void ConfigurationService::reloaded(std::string refusal) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.emplace_back(Reload{std::move(refusal)});
  }
  changed_.notify_one();
}

void ConfigurationService::run(const std::string& file,
                               const configure::ConfigurationAgent::Ports& ports) {
  pthread_setname_np(pthread_self(), "configure");
  configure::ConfigurationAgent agent(file, ports);
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (tasks_.empty()) {
      const auto ready = [this] { return ending_ || !tasks_.empty(); };
      if (!agent.is_watching()) {
        changed_.wait(lock, ready);
      } else if (!changed_.wait_for(lock, kLook, ready)) {
        lock.unlock();
        try {
          agent.look();
        } catch (const std::exception& error) { log_error("configuration", error.what()); }
        lock.lock();
      }
      continue;
    }
    auto task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    serve(agent, std::move(task));
    lock.lock();
  }
}

void ConfigurationService::serve(configure::ConfigurationAgent& agent,
                                 std::variant<Request, Reload> task) {
  try {
    if (const auto* reload = std::get_if<Reload>(&task)) return agent.reloaded(reload->refusal);
    auto& request = std::get<Request>(task);
    ConfigurationMessage& message = request.message;
    if (!request.fault.empty()) {
      message.text = refusal_text(403, request.fault, "");
    } else {
      const configure::Outcome outcome = agent.run(message.text, request.subject);
      message.text = reply_text(outcome.status, outcome.body);
    }
    if (message.text.size() > ConfigurationMessage::kMostBytes)
      message.text =
          refusal_text(413, "the reply is too long for a message",
                       "an administrator changes a configuration of this size in its file");
    respond_(message);
  } catch (const std::exception& error) { log_error("configuration", error.what()); }
}

}  // namespace fieldcast
