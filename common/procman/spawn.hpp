#pragma once

#include <sys/types.h>

#include <string>

#include "common/base/result.hpp"
#include "common/procman/exec_line.hpp"
#include "common/procman/file_descriptor.hpp"

namespace eg::procman {

struct SpawnedProcess {
  pid_t pid = 0;
  FileDescriptor
      output;  ///< stdout and stderr of the process, non-blocking; EIO or end of file when all have closed it
};

/// Starts a program on a terminal of its own, in a session of its own, with default signal handling and `environment`
/// added to that of this process. It is killed when the calling thread ends, in whatever way. Returns when the program
/// has been loaded, or says why it could not be.
base::Result<SpawnedProcess> spawn(const ExecLine& line);

}  // namespace eg::procman
