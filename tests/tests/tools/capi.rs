//! The C library as C and C++ programs use it: built, linked, run, with the bits of Rust, under Valgrind and the
//! sanitizers of the compiler, installed with CMake and found by pkg-config.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, Law};
use bitgrain_kernel::{
    Domain, Drain, GrainState, Group, LossPolicy, NewGrain, Obstacle, Store, World, digest, nudge,
    remove, start, step, step_with, take_out,
};
use bitgrain_tests::root;

/// Output of a program that must end well.
fn run(command: &mut Command) -> String {
    let out = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        out.status.success(),
        "{command:?}\n{}\n{}",
        text(&out.stdout),
        text(&out.stderr)
    );
    text(&out.stdout)
}

/// Builds the library, with these features, and returns where it is.
fn built(name: &str, features: &str) -> PathBuf {
    let target = root().join("target").join(name);
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    run(Command::new(cargo)
        .args(["build", "--release", "--locked", "--features", features])
        .arg("--manifest-path")
        .arg(root().join("kernel/capi/Cargo.toml"))
        .arg("--target-dir")
        .arg(&target));
    target.join("release")
}

static LIBRARY: LazyLock<PathBuf> = LazyLock::new(|| built("capi", ""));

/// Compiles an example with these options and returns the program.
fn compiled(folder: &Path, example: &str, options: &[&str]) -> PathBuf {
    let (compiler, standard) = match example.ends_with(".cpp") {
        true => ("c++", "-std=c++17"),
        false => ("cc", "-std=c99"),
    };
    let program = folder.join(example.replace('.', "-"));
    run(Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(options)
        .arg(root().join("kernel/capi/examples").join(example))
        .arg("-I")
        .arg(root().join("kernel/capi/include"))
        .arg(LIBRARY.join("libbitgrain_capi.a"))
        .args(["-lm", "-o"])
        .arg(&program));
    program
}

const EXAMPLES: [&str; 4] = ["drop.c", "tank.c", "bed.cpp", "record.c"];

fn hash(world: &World<'_, f64>) -> String {
    let whole = digest(world).unwrap().whole;
    whole.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn steps(world: &mut World<'_, f64>, law: &impl Law<f64>, count: usize) {
    for _ in 0..count {
        step(world, law).unwrap();
    }
}

/// The world of `drop.c` in Rust after so many steps, with its numbers as they stand there.
#[allow(clippy::approx_constant)]
fn dropped(count: usize) -> String {
    let law = HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu: 0.5,
    };
    let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), 1e-4, 0.1);
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).unwrap();
    store.add_grain(1, 0, [0.0, 0.0, 1.0], 0.5, 0.5236).unwrap();
    start(&mut store.world(), &law).unwrap();
    steps(&mut store.world(), &law, count);
    hash(&store.world())
}

/// The world of `tank.c` in Rust, and the grains that leave.
fn tank() -> (String, Vec<u32>) {
    type Tank = Store<f64, 20, 400, 80, 2>;
    let law = HertzTsuji::new(2e4, 0.3, 0.6, 0.5);
    let domain = Domain::new([0.0, 0.0, -10.0], [6.0, 6.0, 20.0], [true, true, false]).unwrap();
    let mut tank = Tank::new(domain, 1e-3, 0.5);
    tank.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    tank.add_obstacle(floor).unwrap();
    tank.add_obstacle(Obstacle::sphere([3.0, 0.8, 0.8], 0.6))
        .unwrap();
    tank.set_policy(LossPolicy {
        takes_out: true,
        drain: Some(Drain {
            point: [0.0, 0.0, -1.0],
            normal: [0.0, 0.0, 1.0],
        }),
    });
    let liquid = |grain: &GrainState<f64>| {
        let [x, y, z] = grain.velocity.map(|v| -0.5 * v);
        ([x, y, z + 0.1 * grain.mass], [0.0; 3])
    };
    let mut gone = Vec::new();
    let mut go = |tank: &mut Tank, count: usize| {
        for _ in 0..count {
            let mut world = tank.world();
            step_with(&mut world, &law, liquid).unwrap();
            take_out(&mut world, |d| gone.push(d.grain.id)).unwrap();
        }
    };
    start(&mut tank.world(), &law).unwrap();
    for k in 0..16u32 {
        let [x, y] = [k % 4, k / 4].map(|n| 1.0 + 1.3 * f64::from(n));
        tank.insert([NewGrain {
            id: k + 1,
            group: 0,
            position: [x, y, 3.0],
            radius: 0.5,
            mass: 0.5,
            velocity: [0.0; 3],
            spin: [0.0; 3],
        }])
        .unwrap();
        go(&mut tank, 200);
    }
    let mut world = tank.world();
    remove(&mut world, &[3, 7]).unwrap();
    let place = world.place_of(5).unwrap();
    nudge(&mut world, place, [0.0, 0.0, 2.0], [0.0; 3]).unwrap();
    world.obstacles[1].velocity = [0.0, 0.5, 0.0];
    go(&mut tank, 4000);
    tank.world().obstacles[0].velocity = [0.0, 0.0, -1.0];
    go(&mut tank, 2600);
    let hash = hash(&tank.world());
    (hash, gone)
}

/// The world of `bed.cpp` in Rust.
fn bed() -> String {
    let law = HertzTsuji::new(1e5, 0.3, 0.5, 0.4);
    let domain = Domain::new([0.0, 0.0, -1.0], [8.0, 8.0, 30.0], [true, true, false]).unwrap();
    let mut bed = Box::new(Store::<f64, 343, 4000, 400, 1>::new(domain, 2e-4, 0.1));
    bed.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    bed.add_obstacle(floor).unwrap();
    for k in 0..343u32 {
        let place = [k % 7, k / 7 % 7, k / 49];
        let x = [0, 1, 2].map(|a| {
            let shift = 0.01 * f64::from(k % (a + 3));
            0.6 + 1.12 * f64::from(place[a as usize]) + shift
        });
        let radius = 0.45 + 0.05 * f64::from(k % 3) / 2.0;
        let mass = 4.18879 * radius * radius * radius;
        bed.add_grain(k, 0, x, radius, mass).unwrap();
    }
    start(&mut bed.world(), &law).unwrap();
    steps(&mut bed.world(), &law, 20_000);
    hash(&bed.world())
}

#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn c_and_cpp_give_the_bits_of_rust() {
    let folder = tempfile::tempdir().unwrap();
    let [drop, tank_c, bed_cpp, _] = EXAMPLES.map(|name| {
        let program = compiled(folder.path(), name, &["-O1"]);
        run(&mut Command::new(program))
    });
    let last = |text: &str| text.lines().last().unwrap().to_string();
    assert_eq!(last(&drop), dropped(200_000));
    assert!(drop.starts_with("height 0.49976"), "{drop}");
    let (hash, gone) = tank();
    assert_eq!(last(&tank_c), hash);
    assert!(gone.len() > 5);
    for (line, id) in tank_c.lines().skip(1).zip(&gone) {
        assert!(line.contains(&format!("grain {id} leaves")), "{line}");
    }
    let counts = format!(
        "{} grains, {} left, 9800 steps",
        14 - gone.len(),
        gone.len()
    );
    assert!(tank_c.contains(&counts), "{tank_c}");
    assert_eq!(last(&bed_cpp), bed());
}

/// Two recordings that a C program made are read by the command, which says where they part.
#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn recordings_of_c_are_bisected() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path(), "record.c", &["-O1"]);
    let [one, again, other] =
        [("a.csv", "0"), ("again.csv", "0"), ("b.csv", "1")].map(|(name, word)| {
            let path = folder.path().join(name);
            let text = run(Command::new(&program).arg(word));
            std::fs::write(&path, text).unwrap();
            path
        });
    let bisect = |a: &Path, b: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_bitgrain-under-test"));
        let out = command.arg("bisect").args([a, b]).output().unwrap();
        (out.status.code(), String::from_utf8(out.stdout).unwrap())
    };
    assert_eq!(bisect(&one, &again).0, Some(0));
    let (status, text) = bisect(&one, &other);
    assert_eq!(status, Some(3), "{text}");
    assert!(
        text.contains("different at step") && text.contains("velocities"),
        "{text}"
    );
}

/// Valgrind looks at every access of the library, the sanitizers at those of the program.
#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn examples_touch_no_memory_but_theirs() {
    let folder = tempfile::tempdir().unwrap();
    for name in EXAMPLES {
        let checked = [
            "-g",
            "-O1",
            "-fsanitize=address,undefined",
            "-fno-sanitize-recover",
        ];
        run(&mut Command::new(compiled(folder.path(), name, &checked)));
        let plain = compiled(folder.path(), name, &["-g", "-O1"]);
        let mut valgrind = Command::new("valgrind");
        valgrind.args([
            "--error-exitcode=9",
            "--leak-check=full",
            "--errors-for-leak-kinds=all",
        ]);
        run(valgrind.arg(plain));
    }
}

#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn misuse_is_an_error_and_no_crash() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("misuse");
    run(Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-g"])
        .args(["-fsanitize=address,undefined", "-fno-sanitize-recover"])
        .arg(root().join("tests/rigs/c/misuse.c"))
        .arg("-I")
        .arg(root().join("kernel/capi/include"))
        .arg(LIBRARY.join("libbitgrain_capi.a"))
        .args(["-lm", "-o"])
        .arg(&program));
    assert_eq!(
        run(&mut Command::new(program)),
        "every misuse was refused\n"
    );
}

/// The library asks for a symbol that is nowhere if a panic can be reached.
#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn no_function_of_the_c_library_can_panic() {
    let library = built("capi-probe", "panic-probe").join("libbitgrain_capi.so");
    let symbols = run(Command::new("nm").arg("-D").arg(&library));
    assert!(symbols.contains(" T bg_step_apply"), "{symbols}");
    assert!(!symbols.contains("bg_a_panic_is_reachable"), "{symbols}");
}

#[test]
#[ignore = "builds the C library and compiles C: `.ci/run c`"]
fn installed_it_is_found_by_cmake_and_pkg_config() {
    let folder = tempfile::tempdir().unwrap();
    let (build, prefix) = (folder.path().join("build"), folder.path().join("prefix"));
    run(Command::new("cmake")
        .arg("-S")
        .arg(root().join("kernel/capi"))
        .arg("-B")
        .arg(&build)
        .arg(format!("-DCMAKE_INSTALL_PREFIX={}", prefix.display())));
    run(Command::new("cmake").arg("--build").arg(&build));
    run(Command::new("cmake").arg("--install").arg(&build));

    let app = folder.path().join("app");
    std::fs::create_dir(&app).unwrap();
    std::fs::copy(
        root().join("kernel/capi/examples/drop.c"),
        app.join("drop.c"),
    )
    .unwrap();
    let lists = "cmake_minimum_required(VERSION 3.16)\nproject(app C)\nfind_package(bitgrain 0.1 REQUIRED)\n\
                 add_executable(drop drop.c)\ntarget_link_libraries(drop bitgrain::bitgrain)\n";
    std::fs::write(app.join("CMakeLists.txt"), lists).unwrap();
    run(Command::new("cmake")
        .arg("-S")
        .arg(&app)
        .arg("-B")
        .arg(app.join("build"))
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    run(Command::new("cmake").arg("--build").arg(app.join("build")));
    let dropped = run(&mut Command::new(app.join("build/drop")));

    let config = std::fs::read_dir(&prefix).unwrap();
    let library = config
        .map(|entry| entry.unwrap().path())
        .find(|path| path.join("pkgconfig").is_dir())
        .or_else(|| Some(prefix.join("lib/x86_64-linux-gnu")).filter(|path| path.is_dir()))
        .unwrap();
    let flags = run(Command::new("pkg-config")
        .env("PKG_CONFIG_PATH", library.join("pkgconfig"))
        .args(["--cflags", "--libs", "bitgrain"]));
    let program = app.join("by-pkg-config");
    run(Command::new("cc")
        .arg(app.join("drop.c"))
        .args(flags.split_whitespace())
        .arg("-o")
        .arg(&program));
    let again = run(Command::new(program).env("LD_LIBRARY_PATH", &library));
    assert_eq!(dropped, again);
}

/// Firmware in C, in an emulated Cortex-M4F: the same bits, in the memory that the guide says.
#[test]
#[ignore = "cross-compiles: `.ci/run machines`"]
fn firmware_in_c_gives_the_same_bits() {
    let target = root().join("target/capi-firmware");
    // The compiler that builds its own `core` for other machines.
    run(Command::new("/usr/bin/cargo")
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTC", "/usr/bin/rustc")
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "s")
        .env_remove("RUSTUP_TOOLCHAIN")
        .args(["build", "--release", "--locked", "--no-default-features"])
        .args(["-Z", "build-std=core"])
        .args(["--target", "thumbv7em-none-eabihf", "--manifest-path"])
        .arg(root().join("kernel/capi/Cargo.toml"))
        .arg("--target-dir")
        .arg(&target));
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("firmware.elf");
    let rig = root().join("tests/rigs/c");
    run(Command::new("arm-none-eabi-gcc")
        .args([
            "-mcpu=cortex-m4",
            "-mthumb",
            "-mfloat-abi=hard",
            "-mfpu=fpv4-sp-d16",
        ])
        .args([
            "-Os",
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-ffreestanding",
            "-nostdlib",
        ])
        .args(["-ffunction-sections", "-Wl,--gc-sections", "-T"])
        .arg(rig.join("firmware.ld"))
        .arg(rig.join("firmware.c"))
        .arg("-I")
        .arg(root().join("kernel/capi/include"))
        .arg(target.join("thumbv7em-none-eabihf/release/libbitgrain_capi.a"))
        .args(["-lgcc", "-o"])
        .arg(&image));
    let mut board = Command::new("qemu-system-arm");
    board.args([
        "-M",
        "mps2-an386",
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "none",
    ]);
    board.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    let printed = board.arg(&image).output().unwrap();
    let text = [printed.stdout, printed.stderr].concat();
    let text = String::from_utf8(text).unwrap();
    assert_eq!(text.trim(), dropped(12_000));
    let sizes = run(Command::new("arm-none-eabi-size").arg(&image));
    let row: Vec<&str> = sizes.lines().nth(1).unwrap().split_whitespace().collect();
    let (flash, memory): (u32, u32) = (row[0].parse().unwrap(), row[2].parse().unwrap());
    // Compilers of other versions differ by some hundreds of bytes.
    assert!((104_000..122_000).contains(&flash), "{flash} bytes of code");
    assert_eq!(memory, 3360, "the block of one grain");
}
