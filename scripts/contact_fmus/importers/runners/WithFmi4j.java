import java.io.File;
import java.util.Locale;
import no.ntnu.ihb.fmi4j.SlaveInstance;
import no.ntnu.ihb.fmi4j.importer.AbstractFmu;

/** FMI4j: Java by JNI. The same request and answer as the Python runners (request.py). */
public class WithFmi4j {
    public static void main(String[] args) throws Exception {
        double step = Double.parseDouble(args[1]);
        int count = Integer.parseInt(args[2]);
        AbstractFmu fmu = AbstractFmu.from(new File(args[0]));
        SlaveInstance slave = fmu.asCoSimulationFmu().newInstance("tried");
        int first = 3;
        boolean ready = true;
        for (; ready && first < args.length && args[first].contains(":="); ++first) {
            String[] setting = args[first].substring(args[first].lastIndexOf('=', args[first].indexOf(":=")) + 1).split(":=");
            long[] reference = {Long.parseLong(setting[0])};
            ready = slave.writeInteger(reference, new int[] {Integer.parseInt(setting[1])}).isOK();
        }
        ready = ready &&
            slave.setupExperiment(0.0, 0.0, 0.0) && slave.enterInitializationMode() && slave.exitInitializationMode();
        for (int k = 0; ready && k < count; ++k) {
            ready = slave.doStep(k * step, step);
        }
        if (!ready) {
            System.err.println("a call failed: " + slave.getLastStatus());
            System.exit(1);
        }
        StringBuilder out = new StringBuilder("{\"version\": \"0.38.0\", \"values\": {");
        double[] value = new double[1];
        for (int i = first; i < args.length; ++i) {
            int at = args[i].lastIndexOf('=');
            slave.readReal(new long[] {Long.parseLong(args[i].substring(at + 1))}, value);
            out.append(i > first ? ", " : "").append(String.format(Locale.ROOT, "\"%s\": %.17g", args[i].substring(0, at), value[0]));
        }
        slave.terminate();
        slave.close();
        fmu.close();
        System.out.println(out.append("}}"));
    }
}
