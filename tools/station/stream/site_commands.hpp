// Sends commands of users to the sites of the stream, as requests of NATS to their forwarders. Has
// a connection of its own, which is made for the first command. send() is called by one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/station/live/command_controller.hpp"
#include "tools/station/stream/nats_session.hpp"

namespace fieldcast::web {

struct SiteRequest;

class SiteCommands final : public CommandRoute {
 public:
  // Called once at most for each command that was sent, on a thread of the library.
  using OnOutcome = std::function<void(std::uint64_t request_id, const StationOutcome& outcome)>;

  SiteCommands(const forward::JetStreamSpec& spec, const std::string& station,
               OnOutcome on_outcome);
  // Disconnects. Destroy this object after the threads of the library have ended. No send() later.
  void close();

  // May block while it connects. kNoBridge if the server cannot be reached; a site that is not
  // connected is reported as such by `on_outcome`.
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(StationCommand command) override;
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(AlarmAction action) override;

 private:
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> publish(
      const std::optional<SiteRequest>& request, std::uint64_t request_id);
  [[nodiscard]] bool is_ready();
  [[nodiscard]] std::string id_of(std::uint64_t request_id) const;
  static void on_response(natsConnection*, natsSubscription*, natsMsg* message, void* closure);

  const OnOutcome on_outcome_;
  const std::string process_;  // unique: begins the ids of this process
  std::optional<NatsSession> session_;
  std::uint64_t generation_ = 0;
  std::string inbox_;  // "_INBOX.XYZ"; the subject of a response ends with the request_id
  forward::NatsSubscription responses_;
};

}  // namespace fieldcast::web
