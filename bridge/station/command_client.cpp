#include "bridge/station/command_client.hpp"

#include <unistd.h>

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <random>

namespace fieldcast {

namespace {

constexpr std::size_t kMaxPerson = 64;          // bytes, as for a user's name
constexpr std::size_t kMaxNameWithPerson = 32;  // of the process, so that all fit in 128 bytes

// ":pid:random": unique for each process and object, also across hosts and restarts.
std::string make_identity() {
  std::random_device random;
  const std::uint64_t number = static_cast<std::uint64_t>(random()) << 32 | random();
  return ":" + std::to_string(getpid()) + ":" + std::to_string(number);
}

// Rejects separators of names, line breaks and non-ASCII characters in a requester.
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

StationIdentity::StationIdentity(const std::string& station)
    : StationIdentity(station, make_identity()) {}

StationIdentity::StationIdentity(const std::string& station, const std::string& suffix)
    : name(station),
      short_name(cut_text(name, 128)),
      requester(cut_text(name, kMaxNameLength) + suffix),
      of_persons(cut_text(name, kMaxNameWithPerson) + suffix + '/') {}

CommandClient::CommandClient(Domain& domain, StationIdentity& station)
    : domain_(domain), station_(station), servers_(domain, [this] {
        const std::lock_guard lock(mutex_);
        changed_.notify_all();
      }) {
  listener_.client = this;
  // Results are volatile, so the reader is created before the first command.
  results_ =
      domain_.reader(kCommandResultTopic, &listener_,
                     dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
}

CommandClient::~CommandClient() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_all();
  }
  if (resender_.joinable()) resender_.join();
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
    client->on_result(from_idl(sample));
  }
}

void CommandClient::on_result(StationResult result) {
  {
    const std::lock_guard lock(mutex_);
    if (auto found = kept_.extract(result.request_id)) {
      Kept& kept = found.mapped();
      result.request_id = kept.first_id;
      if (was_not_run(result) && kept.attempts < kMostAttempts && !closing_) {
        kept.refusal = std::move(result);
        kept.next = std::chrono::steady_clock::now() + kTry * (1 << (kept.attempts - 1));
        again_.push_back(std::move(kept));
        if (!resender_.joinable()) resender_ = std::thread([this] { send_again(); });
        return changed_.notify_all();
      }
    }
  }
  deliver(result);
}

void CommandClient::deliver(const StationResult& result) {
  std::function<void(const StationResult&)> handler;
  {
    const std::lock_guard lock(mutex_);
    handler = handler_;
    const auto found = awaited_.find(result.request_id);
    if (found != awaited_.end() && !found->second) {
      found->second = result;
      changed_.notify_all();
    }
  }
  if (handler) handler(result);
}

void CommandClient::send_again() {
  const auto put_back = [this](Kept kept) {
    const std::lock_guard lock(mutex_);
    again_.push_back(std::move(kept));
  };
  std::unique_lock lock(mutex_);
  while (!closing_) {
    changed_.wait(lock, [this] { return closing_ || !again_.empty(); });
    std::vector<Kept> waiting = std::exchange(again_, {});
    lock.unlock();
    for (Kept& kept : waiting) {
      const auto now = std::chrono::steady_clock::now();
      if (now < kept.next) {
        put_back(std::move(kept));
        continue;
      }
      // In whole seconds, because each lifespan has its writer. The id is new, because bridges
      // store the old one.
      const Duration left = kept.ends - now;
      kept.command.lifespan = std::chrono::floor<std::chrono::seconds>(left);
      kept.command.command.request_id = 0;
      tl::expected<std::uint64_t, StationFault> sent = tl::unexpected(StationFault::kNotSent);
      if (kept.command.lifespan > Duration::zero()) {
        Kept next = kept;
        ++next.attempts;
        sent = send(std::move(next), Duration::zero(), false);
      }
      if (sent) continue;
      if (sent.error() != StationFault::kNoBridge) {
        deliver(kept.refusal);
        continue;
      }
      put_back(std::move(kept));
    }
    lock.lock();
    if (!again_.empty()) changed_.wait_for(lock, kTry, [this] { return closing_; });
  }
}

void CommandClient::keep(std::uint64_t request_id, Kept kept) {
  const auto now = std::chrono::steady_clock::now();
  if (kept_.size() >= kMaxKept)
    std::erase_if(kept_, [&](const auto& entry) { return entry.second.ends < now; });
  if (kept_.size() >= kMaxKept) return;
  if (kept.first_id == 0) kept.first_id = request_id;
  kept_.insert_or_assign(request_id, std::move(kept));
}

bool CommandClient::is_ours(std::string_view requester) const {
  return requester == station_.requester || requester.starts_with(station_.of_persons);
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
  // Without mutex_: the library may report matches while it creates the writer.
  auto made = std::make_unique<CommandWriter>();
  made->client = this;
  made->entity = domain_.writer(kCommandTopic, command_writer_qos(lifespan), station_.requester,
                                made.get(), dds::StatusMask::publication_matched());
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
  made->entity =
      domain_.writer(kAlarmActionTopic, alarm_action_writer_qos(kActionLifespan),
                     station_.requester, made.get(), dds::StatusMask::publication_matched());
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

template <class Message, class Note>
tl::expected<std::uint64_t, StationFault> CommandClient::write(Message& message,
                                                               Writer<Message>& writer,
                                                               Duration wait_for_bridge,
                                                               Note note) {
  std::uint64_t id = 0;
  {
    std::unique_lock lock(mutex_);
    const std::string bus = message.bus().c_str();
    if (!changed_.wait_for(lock, wait_for_bridge, [&] { return reaches(bus, writer); }))
      return tl::unexpected(StationFault::kNoBridge);
    if (message.request_id() >= station_.next_id) return tl::unexpected(StationFault::kNotSent);
    id = message.request_id() != 0 ? message.request_id() : station_.next_id++;
    message.request_id(id);
    note(id);
  }
  if (!writer.write(message)) {
    const std::lock_guard lock(mutex_);
    awaited_.erase(id);
    kept_.erase(id);
    return tl::unexpected(StationFault::kNotTaken);
  }
  return id;
}

tl::expected<std::uint64_t, StationFault> CommandClient::send(StationCommand command,
                                                              Duration wait_for_bridge,
                                                              bool awaited) {
  if (!command.person.empty() && !is_person(command.person))
    return tl::unexpected(StationFault::kNoPerson);
  command.command.requester =
      command.person.empty() ? station_.requester : station_.of_persons + command.person;
  Kept kept;
  kept.command = std::move(command);
  return send(std::move(kept), wait_for_bridge, awaited);
}

tl::expected<std::uint64_t, StationFault> CommandClient::send(Kept kept, Duration wait_for_bridge,
                                                              bool awaited) {
  const StationCommand& command = kept.command;
  idl::Command out;
  if (!to_idl(command.bus, command.command, out)) return tl::unexpected(StationFault::kNotSent);
  return write(out, writer_for(command.lifespan), wait_for_bridge, [&](std::uint64_t id) {
    if (awaited) awaited_[id];
    if (kept.attempts == 1) kept.ends = std::chrono::steady_clock::now() + kept.command.lifespan;
    keep(id, std::move(kept));
  });
}

tl::expected<std::uint64_t, StationFault> CommandClient::send(AlarmAction action,
                                                              Duration wait_for_bridge,
                                                              bool awaited) {
  action.requester = station_.requester;
  idl::AlarmAction out;
  if (!to_idl(action, out)) return tl::unexpected(StationFault::kNotSent);
  return write(out, action_writer(), wait_for_bridge, [&](std::uint64_t id) {
    if (awaited) awaited_[id];
  });
}

StationOutcome CommandClient::await(std::uint64_t request_id, Duration wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [&] { return awaited_.at(request_id).has_value(); });
  std::optional<StationResult> result = std::move(awaited_.at(request_id));
  awaited_.erase(request_id);
  if (!result) return tl::unexpected(StationFault::kNoResult);
  return std::move(*result);
}

}  // namespace fieldcast
