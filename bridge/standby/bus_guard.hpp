// Decides whether a starting bridge has waited long enough to discover the other bridges: normally
// up to 0.9 s, longer behind a discovery server or with DDS Security on a busy machine. Then
// bridges were found that have not announced anything. Pure: no thread, no clock, no DDS; one
// owner.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bridge/standby/bus_claims.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// State of bridges that have not announced themselves yet, from DDS.
struct Finding {
  bool has_servers = false;      // discovery servers are configured
  bool server_responds = false;  // at least one of them
  // Bridges found without a writer, and announced members without a message of the group.
  std::size_t unknown = 0;
  std::size_t silent = 0;  // bridges that have not announced what they serve; may be dead
};

class Settling {
 public:
  static constexpr Duration kLeast = std::chrono::seconds{1};
  // Upper limit outside a group.
  static constexpr Duration kMost = std::chrono::seconds{3};
  // Upper limit in a standby group, for a discovery server and for unknown bridges: a bridge that
  // takes over too early would be a second master.
  static constexpr Duration kMostInGroup = std::chrono::seconds{10};
  // In a group, the wait after the response of a discovery server; 0.8 s were measured under load.
  static constexpr Duration kServer = std::chrono::seconds{2};
  // In a group, the wait after the last announcement for the first message as a member.
  static constexpr Duration kMembers = std::chrono::milliseconds{300};

  Settling(bool in_group, Instant began) : in_group_(in_group), began_(began) {}

  // Returns what is waited for, or `std::nullopt` if settled.
  [[nodiscard]] std::optional<std::string> waits_for(const Finding& finding, Instant now) {
    const Duration waited = now - began_;
    if (finding.server_responds) responded_ = std::min(responded_, now);
    if (finding.unknown + finding.silent > 0) silent_ = now;
    if (waited < kLeast) return "the other bridges";
    if (waited >= (in_group_ ? kMostInGroup : kMost)) return std::nullopt;
    if (in_group_ && finding.has_servers) {
      if (responded_ == kNever) return "a discovery server: none has responded";
      if (now - responded_ < kServer) return "what the discovery server knows";
    }
    if (finding.unknown > 0 || (finding.silent > 0 && waited < kMost))
      return std::to_string(finding.unknown + finding.silent) +
             " bridges that are there and have said nothing yet";
    // A bridge that announced late also sends its first group message late.
    const bool late = silent_ - began_ >= kLeast;
    if (in_group_ && late && now - silent_ < kMembers && finding.silent == 0)
      return "what they say of the group";
    return std::nullopt;
  }

 private:
  const bool in_group_;
  const Instant began_;
  Instant responded_ = kNever;  // time of the first response
  Instant silent_ = began_;     // last time at which a bridge was silent
};

// Ensures that only one bridge of the domain serves each bus: announces claims, receives those of
// others, and decides (bus_claims.hpp). Any thread; changed() is called on the guard's thread.
class BusGuard {
 public:
  // Period of checks whether the processes of other bridges on this machine still run.
  static constexpr Duration kCheckPeriod = std::chrono::milliseconds{500};

  struct Handlers {
    std::function<void(const BridgeClaims&)> announce;  // one call at a time
    // serves() or contested() may have changed. `uncontested`: buses that another bridge no longer
    // serves. On the guard's thread, after watch(). If false, it is called again soon.
    std::function<bool(const std::set<std::string>& uncontested)> changed;
    std::function<Finding()> finding;  // without the bridges of found() and of the claims
    // Members of the group that were received there.
    std::function<std::vector<std::string>()> members;
    // Called once on the thread of settle(), if that lasts longer than Settling::kLeast.
    std::function<void(const std::string& what)> waits;
    // Called on the thread of settle() when it stops waiting for this number of silent bridges.
    std::function<void(std::size_t bridges)> unheard;
  };
  BusGuard(std::string bridge, Handlers handlers);
  ~BusGuard();
  BusGuard(const BusGuard&) = delete;
  BusGuard& operator=(const BusGuard&) = delete;

  // ---- other bridges, as discovered by DDS

  void found(const std::string& id);
  void receive(const std::string& id, BridgeClaims claims);
  void set_alive(const std::string& id, bool alive);
  void lost(const std::string& id);

  // ---- this bridge

  // To be called first. The bridge belongs to a standby group and initially stands by.
  void join_group(const std::string& group, std::int32_t strength);
  // Sets whether another bridge of the group serves, and announces it; changed() is not called.
  void stand_by(bool standing_by);
  // Sets the wanted buses. `id` is this bridge's identity in DDS. settle() decides which buses it
  // serves; after settle(), the guard decides by itself.
  void want(const std::string& id, const std::vector<std::string>& buses);
  // Waits until the other bridges had time since want() to announce themselves (Settling), in a
  // group since now, or until `give_up` returns true, then decides. Call once, after want().
  void settle(const std::function<bool()>& give_up);
  [[nodiscard]] bool serves(const std::string& bus) const;
  // The bridge that serves a bus in place of this one, human-readable: "bridge 'b' on host h".
  [[nodiscard]] std::string rival(const std::string& bus) const;
  // The buses that both this bridge and rival() serve.
  [[nodiscard]] std::set<std::string> contested() const;

  // Another member with this bridge's name; only the one with priority (goes_first) may be master.
  [[nodiscard]] std::optional<BusClaims::Namesake> namesake() const;

  // Announces that this bridge wants no bus any more. Without effect, and false, while another
  // bridge wants one: it would take the bus over. Call it after end().
  [[nodiscard]] bool withdraw();

  void watch();  // from now on, changed() is called
  void end();    // after it returns, changed() is not called

 private:
  void run();
  void check_processes();
  // Returns true if the change must be announced. REQUIRES: mutex_ held.
  [[nodiscard]] bool decide();
  void announce();  // REQUIRES: mutex_ not held, because it calls DDS

  const Handlers handlers_;
  std::mutex announcing_;  // locked before mutex_
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  BridgeClaims own_;  // without its buses
  BusClaims claims_;
  std::set<std::string> silent_;  // found, but nothing received yet
  std::set<std::string> contested_;
  std::set<std::string> uncontested_;  // since the last changed()
  Instant wanted_at_ = kLongAgo;       // the first want()
  bool settled_ = false, dirty_ = false, changed_ = false, ending_ = false;
  std::thread thread_;
};

}  // namespace fieldcast
