#include "tools/station/live/live_hub.hpp"

#include <algorithm>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/live/frames.hpp"
#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {

namespace {

// A shorter pause is not reported to the client.
constexpr Duration kLag = std::chrono::milliseconds{250};

std::string result_message(std::optional<std::uint64_t> id, const CommandOutcome& outcome) {
  JsonObject head;
  head.add("kind", "result");
  if (id) head.add("id", *id);
  return json_joined(head.take(), outcome_json(outcome));
}

}  // namespace

LiveClient::LiveClient(LiveContext& context, Caller caller, LivePeer& peer)
    : context_(context), caller_(std::move(caller)), peer_(peer) {}

LiveClient::~LiveClient() { withdraw_all(); }

void LiveClient::on_open(Instant now) {
  open_ = true;
  allowance_at_ = now;
  catalogue_ = context_.model.catalogue_version();
  peer_.send_text(JsonObject()
                      .add("kind", "hello")
                      .add("version", context_.version)
                      .add("user", caller_.user)
                      .add("role", to_text(caller_.role))
                      .add("now_ms", unix_ms(context_.utc_now()))
                      .add("catalogue", catalogue_)
                      .take());
  send_news(now);
}

void LiveClient::on_closed() {
  open_ = false;
  withdraw_all();
}

void LiveClient::withdraw_all() {
  for (const auto& [pattern, refresh] : interests_) context_.interests.remove(pattern, refresh);
  interests_.clear();
}

void LiveClient::on_news(Instant now) {
  if (!open_) return;
  if (!under_way_) return wake_at(std::max(now + kGathering, next_));
  if (now < std::max(next_, counted_ + kPeriod)) return;
  ++dropped_;
  ++counters_.dropped;
  counted_ = now;
}

void LiveClient::wake_at(Instant when) {
  if (when >= wake_) return;
  wake_ = when;
  peer_.wake_at(when);
}

void LiveClient::on_wake(Instant now) {
  wake_ = kNever;
  if (open_) send_news(now);
}

void LiveClient::on_taken(Instant now) {
  under_way_ = false;
  if (!open_) return;
  if (now - sent_ >= kLag && dropped_ > 0)
    peer_.send_text(JsonObject().add("kind", "lag").add("dropped_frames", dropped_).take());
  dropped_ = 0;
  send_news(now);
}

bool LiveClient::add_texts() {
  const LiveObjects::News news = context_.model.objects().since(objects_, kMaxTexts);
  if (news.lost) {
    peer_.close("too far behind");
    open_ = false;
    return false;
  }
  objects_ = news.version;
  for (const auto& message : news.messages) peer_.send_text(*message);
  return !news.messages.empty();
}

bool LiveClient::add_catalogue(Instant now) {
  if (context_.model.catalogue_version() == catalogue_) return false;
  if (now < next_catalogue_) {
    wake_at(next_catalogue_);
    return false;
  }
  catalogue_ = context_.model.catalogue_version();
  next_catalogue_ = now + kCataloguePeriod;
  peer_.send_text(JsonObject().add("kind", "catalogue").add("version", catalogue_).take());
  return true;
}

void LiveClient::send_news(Instant now) {
  if (under_way_) return;
  const bool fresh = context_.model.version() > seen_ && !subscription_.empty();
  if (now < next_) {
    if (fresh || context_.model.objects().version() > objects_ ||
        context_.model.catalogue_version() != catalogue_)
      wake_at(next_);
    return;
  }
  bool some = add_catalogue(now);
  some = add_texts() || some;
  if (!open_) return;
  std::shared_ptr<const std::string> binary;
  if (fresh) {
    const LiveFrame frame = context_.frames.frame(seen_, subscription_, now);
    seen_ = frame.version;
    if (frame.channels != 0) binary = frame.binary;
    if (frame.texts) peer_.send_text(*frame.texts);
  }
  if (!binary) {
    if (!some) return;
    static const auto kNothing = std::make_shared<const std::string>(binary_frame({}));
    binary = kNothing;
  }
  under_way_ = true;
  sent_ = counted_ = now;
  next_ = now + kPeriod;
  ++counters_.frames;
  peer_.send_binary(std::move(binary));
}

void LiveClient::on_outcome(const CommandOutcome& outcome) {
  if (open_) peer_.send_text(result_message({}, outcome));
}

bool LiveClient::within_rate(Instant now) {
  const double passed = to_seconds(now - allowance_at_);
  allowance_ = std::min<double>(kMaxMessages, allowance_ + passed * kMaxMessages);
  allowance_at_ = now;
  if (allowance_ < 1) return false;
  allowance_ -= 1;
  return true;
}

void LiveClient::refuse(std::optional<std::uint64_t> id, const Refusal& refusal) {
  ++counters_.refused;
  JsonObject json;
  json.add("kind", "refused");
  if (id) json.add("id", *id);
  peer_.send_text(json.add("error", refusal.error).add("hint", refusal.hint).take());
}

void LiveClient::on_text(std::string_view message, Instant now) {
  if (!open_) return;
  if (!within_rate(now)) {
    if (++refused_ > kMaxRefused) {
      peer_.close("too many messages");
      return on_closed();
    }
    // Its id identifies the refused message for the client; the content is ignored.
    const auto parsed = parse_client_message(message);
    return refuse(parsed ? parsed->id : parsed.error().id,
                  {"too many messages", "at most 20 a second"});
  }
  refused_ = 0;
  const auto parsed = parse_client_message(message);
  if (!parsed) return refuse(parsed.error().id, parsed.error().refusal);
  handle(*parsed, now);
}

void LiveClient::handle(const ClientMessage& message, Instant now) {
  std::optional<Refusal> refusal;
  if (const auto* wanted = std::get_if<Subscribe>(&message.what)) {
    refusal = subscribe(*wanted, now);
  } else if (const auto* unwanted = std::get_if<Unsubscribe>(&message.what)) {
    refusal = unsubscribe(*unwanted);
  } else if (const auto* written = std::get_if<WriteChannel>(&message.what)) {
    refusal = write(message.id, *written);
  } else if (const auto* acquired = std::get_if<AcquireChannel>(&message.what)) {
    const auto channel = commanded(acquired->path);
    refusal = channel ? submit(message.id, acquire_command(acquired->path))
                      : std::optional(channel.error());
  } else {
    JsonObject pong;
    pong.add("kind", "pong");
    if (message.id) pong.add("id", *message.id);
    peer_.send_text(pong.add("now_ms", unix_ms(context_.utc_now())).take());
  }
  if (refusal) refuse(message.id, *refusal);
}

std::optional<Refusal> LiveClient::subscribe(const Subscribe& wanted, Instant now) {
  if (!subscription_.has(wanted.pattern) && !subscription_.has_room())
    return Refusal{"too many subscriptions", "at most 16; unsubscribe from one first"};
  if (wanted.refresh) {
    const std::string pattern = wanted.pattern.text();
    const auto known = interests_.find(pattern);
    // Add first: otherwise the interest could be withdrawn in between.
    if (!context_.interests.add(pattern, *wanted.refresh))
      return Refusal{"the station has too many interests", "try again later"};
    if (known != interests_.end()) context_.interests.remove(pattern, known->second);
    interests_[pattern] = *wanted.refresh;
  }
  if (subscription_.add(wanted.pattern)) seen_ = 0;
  send_news(now);
  return std::nullopt;
}

std::optional<Refusal> LiveClient::unsubscribe(const Unsubscribe& wanted) {
  if (!subscription_.remove(wanted.pattern))
    return Refusal{"there is no such subscription", "the pattern is that of the subscription"};
  const auto known = interests_.find(wanted.pattern.text());
  if (known != interests_.end()) {
    context_.interests.remove(known->first, known->second);
    interests_.erase(known);
  }
  return std::nullopt;
}

tl::expected<const LiveChannel*, Refusal> LiveClient::commanded(const ChannelPath& path) const {
  if (!may(caller_.role, Role::kOperator))
    return tl::unexpected(Refusal{"your role is " + std::string(to_text(caller_.role)),
                                  "commands need the role operator; log in as somebody else"});
  const LiveChannel* const channel = context_.model.find(path);
  if (channel == nullptr || channel->gone)
    return tl::unexpected(Refusal{"channel " + printable(path.text(), 200) + " is unknown",
                                  "no bridge announces it at present"});
  if (channel->origin == Origin::kStream && !context_.commands.reaches_stream())
    return tl::unexpected(refusal_of_stream(path.bus));
  return channel;
}

std::optional<Refusal> LiveClient::write(std::optional<std::uint64_t> id,
                                         const WriteChannel& wanted) {
  const auto channel = commanded(wanted.path);
  if (!channel) return channel.error();
  auto value = value_for((*channel)->channel.type, wanted.value);
  if (!value) return value.error();
  return submit(id, write_command(wanted.path, std::move(*value), wanted.verify));
}

std::optional<Refusal> LiveClient::submit(std::optional<std::uint64_t> id, StationCommand command) {
  const auto request =
      context_.commands.submit(caller_, std::move(command),
                               [id, self = std::weak_ptr(self_)](const CommandOutcome& outcome) {
                                 const auto client = self.lock();
                                 if (client && (*client)->open_)
                                   (*client)->peer_.send_text(result_message(id, outcome));
                               });
  return request ? std::nullopt : std::optional(request.error());
}

namespace {

void add(LiveClient::Counters& to, const LiveClient::Counters& more) {
  to.frames += more.frames;
  to.dropped += more.dropped;
  to.refused += more.refused;
}

}  // namespace

class LiveHub::Member : public LiveClient {
 public:
  Member(LiveHub& hub, const Caller& caller, LivePeer& peer)
      : LiveClient(hub.context_, caller, peer), hub_(hub) {}
  ~Member() override { hub_.leave(*this); }
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;

 private:
  LiveHub& hub_;
};

std::unique_ptr<LiveProtocol> LiveHub::make(const Caller& caller, LivePeer& peer) {
  auto client = std::make_unique<Member>(*this, caller, peer);
  clients_.insert(client.get());
  return client;
}

void LiveHub::leave(Member& member) {
  add(before_, member.counters());
  clients_.erase(&member);
}

void LiveHub::on_news(Instant now) {
  for (Member* client : clients_) client->on_news(now);
}

void LiveHub::on_outcome(const CommandOutcome& outcome) {
  for (Member* client : clients_) {
    if (client->caller().user == outcome.user) client->on_outcome(outcome);
  }
}

LiveClient::Counters LiveHub::counters() const {
  LiveClient::Counters all = before_;
  for (const Member* client : clients_) add(all, client->counters());
  return all;
}

}  // namespace fieldcast::web
