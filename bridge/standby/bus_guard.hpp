// Makes sure that each bus is served by one bridge of the domain: tells the others what this one
// wants and serves, receives what they tell, and decides (bus_claims.hpp). Functions may be called
// from any thread; changed() comes on a thread of the guard's own.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bridge/standby/bus_claims.hpp"
#include "bridge/standby/settling.hpp"

namespace fieldcast {

class BusGuard {
 public:
  // Between two checks whether the process of another bridge, under the same kernel, still runs.
  static constexpr Duration kCheckPeriod = std::chrono::milliseconds{500};

  struct Handlers {
    std::function<void(const BridgeClaims&)> announce;  // tells the others; one call at a time
    // serves() or contested() may have changed. `uncontested`: buses that another bridge served as
    // well, and serves no longer. On the guard's thread, after watch(). False: not possible now; it
    // is called again in a moment.
    std::function<bool(const std::set<std::string>& uncontested)> changed;
    std::function<UtcTime()> now;
    std::function<Finding()> finding;  // without those of found(), and of the claims
    std::function<std::vector<std::string>()> members;  // of the group, that are heard there
    // What settle() waits for when it takes longer than Settling::kLeast. On its thread; once.
    std::function<void(const std::string& what)> waits;
    // So many are there and have said nothing when settle() gives up waiting for them. The same.
    std::function<void(std::size_t bridges)> unheard;
  };
  BusGuard(std::string bridge, Handlers handlers);
  ~BusGuard();  // end()
  BusGuard(const BusGuard&) = delete;
  BusGuard& operator=(const BusGuard&) = delete;

  // ---- the others, as DDS finds them

  void found(const std::string& id);  // it has not said anything yet
  void receive(const std::string& id, BridgeClaims claims);
  void set_alive(const std::string& id, bool alive);
  void lost(const std::string& id);

  // ---- this bridge

  // Before everything else: it belongs to a standby group, and stands by at first.
  void join_group(const std::string& group, std::int32_t strength);
  // Whether another bridge of the group serves. The others are told; changed() is not called.
  void stand_by(bool standing_by);
  // Wants these buses and no others; `id` is its own in DDS. What it serves is decided by settle(),
  // or by itself once that was called.
  void want(const std::string& id, const std::vector<std::string>& buses);
  // Waits until the others can have announced themselves (settling.hpp), or until `give_up` says
  // so, then decides. Once.
  void settle(const std::function<bool()>& give_up);
  [[nodiscard]] bool serves(const std::string& bus) const;
  // The one that serves a bus in place of this bridge, for people: "bridge 'b' on host h".
  [[nodiscard]] std::string rival(const std::string& bus) const;
  // The buses that this bridge serves and rival() serves as well.
  [[nodiscard]] std::set<std::string> contested() const;

  // Another member of the group has the name of this one: it goes first, and this one must not be
  // master; or this one goes first.
  [[nodiscard]] std::optional<BusClaims::Namesake> namesake() const;

  void watch();  // changed() is called from here on
  void end();    // changed() is not called any more when it returns

 private:
  void run();
  void check_processes();
  [[nodiscard]] bool decide();  // true: others must be told. REQUIRES: mutex_ held.
  void announce();              // REQUIRES: mutex_ not held, as it enters DDS

  const Handlers handlers_;
  std::mutex announcing_;  // before mutex_
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  BridgeClaims own_;  // without its buses
  BusClaims claims_;
  std::set<std::string> silent_;       // found, and nothing received from them yet
  std::set<std::string> contested_;    // as of the last decision
  std::set<std::string> uncontested_;  // since changed() was called
  bool settled_ = false, dirty_ = false, changed_ = false, ending_ = false;
  std::thread thread_;
};

}  // namespace fieldcast
