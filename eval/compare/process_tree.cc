#include "eval/compare/process_tree.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(pid_t process) {
  return "/proc/" + std::to_string(process);
}

/// Of all its threads: each has the children that it has started.
std::vector<pid_t> ChildrenOf(pid_t process) {
  std::vector<pid_t> children;
  std::error_code error;
  for (fs::directory_iterator thread(FolderOf(process) + "/task", error), end; !error && thread != end;
       thread.increment(error)) {
    std::ifstream file(thread->path() / "children");
    for (pid_t child = 0; file >> child;) {
      children.push_back(child);
    }
  }
  return children;
}

/// The root first.
std::vector<pid_t> TreeOf(pid_t root) {
  std::vector<pid_t> tree = {root};
  for (size_t i = 0; i < tree.size(); ++i) {
    for (const pid_t child : ChildrenOf(tree[i])) {
      if (std::find(tree.begin(), tree.end(), child) == tree.end()) {
        tree.push_back(child);
      }
    }
  }
  return tree;
}

}  // namespace

int64_t MemoryOfTree(pid_t root) {
  static const int64_t page = ::sysconf(_SC_PAGESIZE);
  int64_t pages = 0;
  for (const pid_t process : TreeOf(root)) {
    std::ifstream file(FolderOf(process) + "/statm");
    int64_t size = 0, resident = 0, shared = 0;
    if (file >> size >> resident >> shared) {
      pages += resident - shared;
    }
  }
  return pages * page;
}

void KillTree(pid_t root) {
  std::vector<pid_t> tree;
  for (size_t before = 0; tree.empty() || tree.size() > before;) {
    before = tree.size();
    tree = TreeOf(root);
    for (const pid_t process : tree) {
      ::kill(process, SIGSTOP);
    }
  }
  for (const pid_t process : tree) {
    ::kill(process, SIGKILL);
  }
}

}  // namespace alidade
