// Which write commands were taken, kept in the store before they run: one that comes again after a
// restart of the bridge, however that ended, is known and does not run a second time.
//
// A thread and a connection of its own, so that commands wait for no batch of samples; what comes
// while it commits is committed together.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/store/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class CommandIdentities {
 public:
  // As long as the longest LIFESPAN that counts (RequestWriters::kLongest), the newest of them.
  static constexpr Duration kKept = std::chrono::hours{24};
  static constexpr std::int64_t kMaxKept = 1'000'000;
  // Commands that may wait for the database, and how long they do when it is away.
  static constexpr std::size_t kMaxWaiting = 4096;
  static constexpr Duration kPatience = std::chrono::seconds{2};

  enum class Verdict : std::uint8_t {
    kNew,      // committed now, by nobody before: it may run
    kKnown,    // taken before, perhaps by a bridge that has ended since
    kNotKept,  // the store did not take it
  };
  using Done = std::function<void(Verdict)>;

  explicit CommandIdentities(const StoreAddress& address);
  ~CommandIdentities();  // close()
  CommandIdentities(const CommandIdentities&) = delete;
  CommandIdentities& operator=(const CommandIdentities&) = delete;

  // Any thread; never blocks. `done` is called once, on the thread of this object, in the order of
  // the calls; at once, here, when too many wait.
  void enter(std::string requester, std::uint64_t request_id, Done done);

  // What waits gets its verdict now; what comes later is not kept. When it returns, nothing is
  // under way but what enters meanwhile. One thread; a second call has no effect.
  void close();

 private:
  struct Entry {
    std::string requester;
    std::uint64_t request_id;
    Done done;
  };
  void run(BoundedQueue<Entry>& queue);
  void open();
  [[nodiscard]] std::vector<Verdict> keep(const std::deque<Entry>& batch,
                                          BoundedQueue<Entry>& queue);
  [[nodiscard]] std::vector<Verdict> commit(const std::deque<Entry>& batch);
  void remove_old();

  const StoreAddress address_;
  std::unique_ptr<SqlConnection> connection_;  // the thread's
  std::size_t since_removal_ = 0;              // the thread's: entries
  Worker<Entry> worker_;                       // last: it uses what is above
};

}  // namespace fieldcast
