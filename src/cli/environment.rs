//! The process's environment, set before anything else runs. The command line's only unsafe code is here.

/// Gives Mesa's Vulkan drivers a folder for run-time files where the system has set none.
///
/// Without one they write a line to stderr at every start, where only our own messages belong. Must be called before
/// the first thread starts.
pub(super) fn prepare() {
    const NAME: &str = "XDG_RUNTIME_DIR";
    if cfg!(unix) && std::env::var_os(NAME).is_none() {
        #[allow(unsafe_code, reason = "set_var is unsafe")]
        // SAFETY: `main` calls this first, so no other thread can read the environment meanwhile.
        unsafe {
            std::env::set_var(NAME, std::env::temp_dir());
        }
    }
}
