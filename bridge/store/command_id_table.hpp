// Stores the identity of each write command before it runs, so that it does not run again after a
// restart or crash of the bridge. Has its own thread and connection, so that commands do not wait
// for samples. Commands that arrive during a commit are committed together.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class CommandIdTable {
 public:
  // The longest effective LIFESPAN (RequestWriters::kLongest); at most the newest kMaxKept.
  static constexpr Duration kKept = std::chrono::hours{24};
  static constexpr std::int64_t kMaxKept = 1'000'000;
  // Limit of commands that wait for the database, and of their wait if it is not available.
  static constexpr std::size_t kMaxWaiting = 4096;
  static constexpr Duration kPatience = std::chrono::seconds{2};

  enum class Verdict : std::uint8_t {
    kNew,      // committed now for the first time; it may run
    kKnown,    // accepted before, perhaps by a bridge that has ended
    kNotKept,  // the store did not save it
    // Only in a standby group: not all bridges have noted it, or one of them has begun it.
    kNotNoted,
  };
  using Done = std::function<void(Verdict)>;

  explicit CommandIdTable(const StoreAddress& address);
  ~CommandIdTable();
  CommandIdTable(const CommandIdTable&) = delete;
  CommandIdTable& operator=(const CommandIdTable&) = delete;

  // Any thread; never blocks. `done` is called once, on the thread of this object, in the order of
  // the calls. If too many commands wait, it is called immediately on the caller's thread.
  void enter(std::string requester, std::uint64_t request_id, Done done);

  // Waiting commands get their verdict now; later ones get kNotKept. When it returns, none is
  // pending except those entered meanwhile. One thread; may be called twice.
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
  std::unique_ptr<SqlConnection> connection_;  // used by the thread
  std::size_t since_removal_ = 0;              // used by the thread: number of entries
  Worker<Entry> worker_;                       // last: it uses the members above
};

}  // namespace fieldcast
