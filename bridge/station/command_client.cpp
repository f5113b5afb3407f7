#include "bridge/station/command_client.hpp"

#include <unistd.h>

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <random>

namespace fieldcast {

namespace {

constexpr std::size_t kMaxPerson = 64;          // bytes, as of a user's name
constexpr std::size_t kMaxNameWithPerson = 32;  // of the process, so that all fit in 128 bytes

// ":pid:random": unique for each process and object, also across hosts and restarts.
std::string make_identity() {
  std::random_device random;
  const std::uint64_t number = static_cast<std::uint64_t>(random()) << 32 | random();
  return ":" + std::to_string(getpid()) + ":" + std::to_string(number);
}

// What separates names, changes a line or is no ASCII never gets into a requester.
bool is_person(std::string_view name) {
  return !name.empty() && name.size() <= kMaxPerson &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  std::string_view("-_.@").find(c) != std::string_view::npos;
         });
}

auto participant_of(const dds::InstanceHandle_t& endpoint) {
  return rtps::iHandle2GUID(endpoint).guidPrefix;
}

}  // namespace

CommandClient::CommandClient(Domain& domain, const std::string& name)
    : CommandClient(domain, name, make_identity()) {}

CommandClient::CommandClient(Domain& domain, const std::string& name, const std::string& identity)
    : domain_(domain),
      requester_(cut_text(name, kMaxNameLength) + identity),
      of_persons_(cut_text(name, kMaxNameWithPerson) + identity + '/'),
      servers_(domain, [this] {
        const std::lock_guard lock(mutex_);
        changed_.notify_all();
      }) {
  listener_.client = this;
  // Results are volatile: the reader comes before the first command.
  results_ =
      domain_.reader(kCommandResultTopic, &listener_,
                     dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
}

CommandClient::~CommandClient() {
  for (auto& [lifespan, writer] : writers_) domain_.remove(writer->entity);
  if (actions_) domain_.remove(actions_->entity);
  domain_.remove(results_);
}

void CommandClient::on_result(std::function<void(const StationResult&)> handler) {
  const std::lock_guard lock(mutex_);
  handler_ = std::move(handler);
}

void CommandClient::Matches::on_publication_matched(dds::DataWriter*,
                                                    const dds::PublicationMatchedStatus& status) {
  const std::lock_guard lock(client->mutex_);
  if (status.current_count_change > 0) {
    found_new = true;
    readers.insert(status.last_subscription_handle);
  } else {
    readers.erase(status.last_subscription_handle);
  }
  client->changed_.notify_all();
}

void CommandClient::ResultListener::on_subscription_matched(
    dds::DataReader*, const dds::SubscriptionMatchedStatus& status) {
  const std::lock_guard lock(client->mutex_);
  if (status.current_count_change > 0) {
    client->result_writers_.insert(status.last_publication_handle);
  } else {
    client->result_writers_.erase(status.last_publication_handle);
  }
  client->changed_.notify_all();
}

void CommandClient::ResultListener::on_data_available(dds::DataReader* reader) {
  idl::CommandResult sample;
  dds::SampleInfo info;
  while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data || !client->is_ours(sample.requester().c_str())) continue;
    StationResult result = from_idl(sample);
    std::function<void(const StationResult&)> handler;
    {
      const std::lock_guard lock(client->mutex_);
      handler = client->handler_;
      const auto found = client->awaited_.find(result.request_id);
      if (found != client->awaited_.end() && !found->second) {
        found->second = result;
        client->changed_.notify_all();
      }
    }
    if (handler) handler(result);
  }
}

bool CommandClient::is_ours(std::string_view requester) const {
  return requester == requester_ || requester.starts_with(of_persons_);
}

std::uint64_t CommandClient::reserve_request_id() {
  const std::lock_guard lock(mutex_);
  return next_id_++;
}

CommandClient::CommandWriter& CommandClient::writer_for(Duration lifespan) {
  const std::lock_guard making(making_);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = writers_.find(lifespan); found != writers_.end()) return *found->second;
    if (writers_.size() >= kMaxLifespans) {
      const auto above = writers_.upper_bound(lifespan);
      return above == writers_.begin() ? *above->second : *std::prev(above)->second;
    }
  }
  // Not under mutex_: the library may tell of matches while it makes the writer.
  auto made = std::make_unique<CommandWriter>();
  made->client = this;
  made->entity = domain_.writer(kCommandTopic, command_writer_qos(lifespan), requester_, made.get(),
                                dds::StatusMask::publication_matched());
  made->once.attach(made->entity);
  const std::lock_guard lock(mutex_);
  return *(writers_[lifespan] = std::move(made));
}

CommandClient::ActionWriter& CommandClient::action_writer() {
  const std::lock_guard making(making_);
  {
    const std::lock_guard lock(mutex_);
    if (actions_) return *actions_;
  }
  auto made = std::make_unique<ActionWriter>();
  made->client = this;
  made->entity = domain_.writer(kAlarmActionTopic, alarm_action_writer_qos(kActionLifespan),
                                requester_, made.get(), dds::StatusMask::publication_matched());
  made->once.attach(made->entity);
  const std::lock_guard lock(mutex_);
  return *(actions_ = std::move(made));
}

bool CommandClient::reaches(const std::string& bus, const Matches& writer) const {
  const auto has = [](const std::set<dds::InstanceHandle_t>& endpoints, const auto& participant) {
    return std::any_of(endpoints.begin(), endpoints.end(), [&](const auto& endpoint) {
      return participant_of(endpoint) == participant;
    });
  };
  // Commands are volatile: a bridge that is found later never gets them.
  const auto now = std::chrono::steady_clock::now();
  bool any = false, all = true;
  for (const BusServers::Taker& taker : servers_.takers(bus)) {
    const bool reached =
        has(writer.readers, taker.participant) && has(result_writers_, taker.participant);
    any |= reached;
    all &= reached || now - std::max(taker.since, writer.made) >= kLongestMatch;
  }
  return any && all;
}

template <class Message>
tl::expected<std::uint64_t, StationFault> CommandClient::send(Message& message,
                                                              Writer<Message>& writer,
                                                              Duration wait_for_bridge,
                                                              bool awaited) {
  std::uint64_t id = 0;
  {
    std::unique_lock lock(mutex_);
    const std::string bus = message.bus().c_str();
    if (!changed_.wait_for(lock, wait_for_bridge, [&] { return reaches(bus, writer); }))
      return tl::unexpected(StationFault::kNoBridge);
    if (message.request_id() >= next_id_) return tl::unexpected(StationFault::kNotSent);
    id = message.request_id() != 0 ? message.request_id() : next_id_++;
    message.request_id(id);
    if (awaited) awaited_[id];
  }
  if (!writer.write(message)) {
    const std::lock_guard lock(mutex_);
    awaited_.erase(id);
    return tl::unexpected(StationFault::kNotSent);
  }
  return id;
}

tl::expected<std::uint64_t, StationFault> CommandClient::send(StationCommand command,
                                                              Duration wait_for_bridge,
                                                              bool awaited) {
  if (!command.person.empty() && !is_person(command.person))
    return tl::unexpected(StationFault::kNoPerson);
  command.command.requester = command.person.empty() ? requester_ : of_persons_ + command.person;
  idl::Command out;
  if (!to_idl(command.bus, command.command, out)) return tl::unexpected(StationFault::kNotSent);
  return send(out, writer_for(command.lifespan), wait_for_bridge, awaited);
}

tl::expected<std::uint64_t, StationFault> CommandClient::send(AlarmAction action,
                                                              Duration wait_for_bridge,
                                                              bool awaited) {
  action.requester = requester_;
  idl::AlarmAction out;
  if (!to_idl(action, out)) return tl::unexpected(StationFault::kNotSent);
  return send(out, action_writer(), wait_for_bridge, awaited);
}

StationOutcome CommandClient::execute(StationCommand command, Duration wait_for_bridge,
                                      Duration wait_for_result) {
  const auto began = std::chrono::steady_clock::now();
  const Duration lifespan = command.lifespan;
  tl::expected<StationResult, StationFault> outcome = tl::unexpected(StationFault::kNotSent);
  for (int attempt = 1;; ++attempt) {
    const auto id = send(command, wait_for_bridge, true);
    if (!id) return attempt == 1 ? tl::unexpected(id.error()) : outcome;
    outcome = await(*id, command.lifespan + wait_for_result);
    if (!outcome || !was_not_run(*outcome) || attempt == kMostAttempts) return outcome;
    // In whole seconds: each lifespan has its writer. A new id, as bridges remember the old one.
    const Duration spent = std::chrono::steady_clock::now() - began;
    command.lifespan = std::chrono::floor<std::chrono::seconds>(lifespan - spent);
    if (command.lifespan <= Duration::zero()) return outcome;
    command.command.request_id = 0;
    wait_for_bridge = std::min(wait_for_bridge, command.lifespan);
  }
}

tl::expected<StationResult, StationFault> CommandClient::await(std::uint64_t request_id,
                                                               Duration wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [&] { return awaited_.at(request_id).has_value(); });
  std::optional<StationResult> result = std::move(awaited_.at(request_id));
  awaited_.erase(request_id);
  if (!result) return tl::unexpected(StationFault::kNoResult);
  return std::move(*result);
}

}  // namespace fieldcast
