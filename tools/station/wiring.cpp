#include "tools/station/wiring.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fieldcast::web {

namespace {

void add_stream_metrics(const LiveObjects& objects, const StreamReader::Counters& counters,
                        std::vector<Metric>& all) {
  const auto add = [&all](const char* name, bool counter, const char* help, auto value) {
    all.push_back({name, counter, help, static_cast<double>(value)});
  };
  const auto streams = objects.all<LiveStream>();
  add("stream_connected", false, "1 while the stream of the sites can be read.",
      !streams.empty() && streams.front()->connected);
  add("stream_messages_total", true, "Messages with present samples of sites.", counters.messages);
  add("stream_refused_messages_total", true, "Messages of sites that could not be decoded.",
      counters.refused);
  add("stream_recorded_samples_total", true, "Samples of sites handed to the store.",
      counters.recorded);
  add("stream_repeated_samples_total", true, "Samples of sites that were received before.",
      counters.repeated);
  const std::vector<const LiveSite*> sites = objects.all<LiveSite>();
  const auto add_all = [&](const char* name, const char* help, auto value) {
    for (const LiveSite* site : sites)
      all.push_back({name, false, help, static_cast<double>(value(*site)), site->site});
  };
  add_all("site_connected", "1 if the site was heard in the last 30 s.",
          [](const LiveSite& site) { return site.connected; });
  add_all("site_heard_timestamp_seconds", "When the site was last heard, by the server's clock.",
          [](const LiveSite& site) { return to_seconds(Duration{site.heard_at.nanoseconds}); });
  add_all("site_backlog_records", "Messages that wait at the site.",
          [](const LiveSite& site) { return site.backlog_records; });
  add_all("site_clock_ahead_seconds",
          "By how much the server's clock was ahead of the site's at its last report.",
          [](const LiveSite& site) { return to_seconds(site.clock_ahead); });
  add_all("site_refused_messages", "Messages of the site that could not be decoded.",
          [](const LiveSite& site) { return site.refused; });
}

}  // namespace

std::vector<Metric> metrics_of(const LiveDomain& domain, const StreamReader* stream,
                               const StationServer& server) {
  std::vector<Metric> all;
  const auto add = [&all](const char* name, bool counter, const char* help, auto value) {
    all.push_back({name, counter, help, static_cast<double>(value)});
  };
  const LiveDomain::Counters live = domain.counters();
  add("channels", false, "Channels that bridges announce.", live.channels);
  add("samples_total", true, "Samples that came.", live.inbox.samples);
  add("samples_overtaken_total", true, "Samples with a newer one before pages saw them.",
      live.inbox.overtaken);
  add("missing_blocks_total", true, "Blocks of samples that never came.", live.blocks.missing);
  add("clients", false, "Clients of /live.", live.connected);
  add("frames_total", true, "Binary frames sent to clients.", live.clients.frames);
  add("frames_dropped_total", true, "Frames not made since a client was slow.",
      live.clients.dropped);
  add("frames_encoded_total", true, "Frames that were made; several clients may share one.",
      live.frames.encoded);
  add("messages_refused_total", true, "Messages of clients that were refused.",
      live.clients.refused);
  add("interests", false, "Interests declared for clients.", live.interests);
  Duration offset{};
  for (const StationBusStatus* bus : domain.model().objects().all<StationBusStatus>())
    offset = std::max(offset, std::chrono::abs(bus->clock_ahead.value_or(Duration{})));
  add("largest_clock_offset_seconds", false,
      "Largest difference between the clocks of this station and of a bridge.", to_seconds(offset));
  if (stream != nullptr) add_stream_metrics(domain.model().objects(), stream->counters(), all);
  const StationCounters web = server.counters();
  add("connections_total", true, "HTTP connections accepted.", web.connections);
  add("connections", false, "HTTP connections now.", web.open);
  add("turned_away_total", true, "Connections and clients beyond a limit.", web.turned_away);
  return all;
}

std::optional<Role> local_role_of(const StationSpec& spec, std::optional<std::size_t> users) {
  if (!on_loopback(spec.web.listen)) return std::nullopt;
  if (spec.web.local_role) {
    switch (*spec.web.local_role) {
      case LocalRole::kNone: return std::nullopt;
      case LocalRole::kViewer: return Role::kViewer;
      case LocalRole::kOperator: return Role::kOperator;
      case LocalRole::kEngineer: return Role::kEngineer;
    }
  }
  if (!spec.store || users == 0u) return Role::kViewer;
  return std::nullopt;
}

UserWatch::UserWatch(boost::asio::io_context& io, const StationSpec& spec, Site& site, Ask ask)
    : spec_(spec), site_(site), ask_(std::move(ask)), timer_(io) {
  site_.set_local_role(local_role_of(spec_, std::nullopt));
}

UserWatch::~UserWatch() = default;

void UserWatch::look() {
  if (!ask_) return;
  ask_([this, alive = std::weak_ptr(alive_)](const Users& users) {
    if (!alive.expired()) on_users(users);
  });
}

// If the store cannot be read, logins and the local role remain unchanged.
void UserWatch::on_users(const Users& users) {
  if (users) {
    users_ = users->size();
    site_.book().users_are(*users);
  }
  site_.set_local_role(local_role_of(spec_, users_));
  timer_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(kPeriod));
  timer_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) look();
  });
}

}  // namespace fieldcast::web
