// Libraries that hold a name and nothing else.
#include "runtime/device/pocl_stub.h"

#include <gmock/gmock.h>

#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace gradus {
namespace {

TEST(PoclStub, IsALibraryWithItsSymbol) {
    const std::filesystem::path file =
        std::filesystem::path(::testing::TempDir()) / ("gradus-stub-" + std::to_string(getpid()) + ".so");
    std::ofstream(file, std::ios::binary) << library_with_symbol("_pocl_kernel_scatter_workgroup");
    void *library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr) << dlerror();
    EXPECT_NE(dlsym(library, "_pocl_kernel_scatter_workgroup"), nullptr);
    EXPECT_EQ(dlsym(library, "_pocl_kernel_scatter"), nullptr);
    dlclose(library);
    std::filesystem::remove(file);
}

TEST(PoclStub, IsPutBesideProgramsThatHaveNoCodeYet) {
    const std::filesystem::path cache =
        std::filesystem::path(::testing::TempDir()) / ("gradus-stubs-" + std::to_string(getpid()));
    const auto make = [](const std::filesystem::path &file) {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << "kept";
    };
    make(cache / "AB" / "CDEF" / "program.bc");
    make(cache / "AB" / "CDEF" / "old" / "0-0-0" / "old.so");
    make(cache / "AB" / "GHIJ" / "something");
    DeviceDescription device;
    device.driver = "3.1";
    PoclStubs stubs(cache, device);
    stubs.put({{"new", {}}, {"old", {}}});
    EXPECT_GT(std::filesystem::file_size(cache / "AB" / "CDEF" / "new" / "0-0-0" / "new.so"), 100u);
    EXPECT_EQ(std::filesystem::file_size(cache / "AB" / "CDEF" / "old" / "0-0-0" / "old.so"), 4u);
    EXPECT_FALSE(std::filesystem::exists(cache / "AB" / "GHIJ" / "new"));
    stubs.put({{"of the next program", {}}});
    EXPECT_FALSE(std::filesystem::exists(cache / "AB" / "CDEF" / "of the next program"));

    device.driver = "6.0";
    PoclStubs(cache, device).put({{"newer", {}}});
    EXPECT_FALSE(std::filesystem::exists(cache / "AB" / "CDEF" / "newer")) << "tried with 3.1 only";
    std::filesystem::remove_all(cache);
}

} // namespace
} // namespace gradus
