#include "eval/files/folder_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

// GIVEN a folder that another process has locked WHEN it is to be locked THEN it is refused, until that
// process has died.
TEST(FolderLock, IsHeldByOneProcessAndNotByADeadOne) {
  const test::TemporaryFolder folder;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const char locked = LockFolder(folder.path()).ok() ? 1 : 0;
    _exit(write(ready[1], &locked, 1) == 1 ? pause() : 1);
  }
  char locked = 0;
  ASSERT_EQ(read(ready[0], &locked, 1), 1);
  ASSERT_EQ(locked, 1);
  const Status refused = LockFolder(folder.path());
  EXPECT_EQ(refused.code(), StatusCode::kOutput);
  EXPECT_EQ(refused.message(), folder.path() + ": another process is writing there");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(LockFolder(folder.path()).ok());
  EXPECT_TRUE(LockFolder(folder.path()).ok()) << "again in the same process";
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace alidade
