// The messages of the DDS library in the log of a daemon.
#pragma once

namespace fieldcast {

// Messages are counted by their kind, because any sender in the domain can cause them. Those about
// security are lines of their own. Call it after open_log().
void log_library_messages();

}  // namespace fieldcast
